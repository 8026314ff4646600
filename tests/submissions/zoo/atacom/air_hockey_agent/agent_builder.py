from air_hockey_agent.atacom import Tangent


def build_agent(env_info, **kwargs):
    return Tangent(env_info, **kwargs)
