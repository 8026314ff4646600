from air_hockey_agent.sway import Sway


def build_agent(env_info, **kwargs):
    if "3dof" in env_info["env_name"]:
        return Sway(env_info, **kwargs)
    raise NotImplementedError
