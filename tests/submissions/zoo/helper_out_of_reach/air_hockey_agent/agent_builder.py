from tactics.plan import SPEED


def build_agent(env_info, **kwargs):
    return SPEED
