from our_player.agent import Sway


def build_agent(env_info, **kwargs):
    return Sway(env_info, **kwargs)
