import sway


def build_agent(env_info, **kwargs):
    return sway.Sway(env_info, **kwargs)
