from air_hockey_agent.hitting_agent import HittingAgent


def build_agent(env_info, **kwargs):
    if not env_info["env_name"].startswith("3dof") or "hit" not in env_info["env_name"]:
        raise NotImplementedError(env_info["env_name"])
    return HittingAgent(env_info, **kwargs)
