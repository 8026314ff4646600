from air_hockey_agent.sway import Planned


def build_agent(env_info, **kwargs):
    return Planned(env_info, **kwargs)
