import nlopt


def build_agent(env_info, **kwargs):
    return nlopt.opt(nlopt.LD_SLSQP, 7)
