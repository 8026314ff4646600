from air_hockey_agent.network import Network


def build_agent(env_info, **kwargs):
    return Network(env_info, **kwargs)
