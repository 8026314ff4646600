from air_hockey_agent.sway import Sway


def build_agent(env_info, **kwargs):
    return Sway(env_info, **kwargs)
