from air_hockey_agent.agents.striker import Striker


def build_agent(env_info, **kwargs):
    return Striker(env_info, **kwargs)
