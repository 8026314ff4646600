from third_party.learners.sac import policy


def build_agent(env_info, **kwargs):
    return policy(env_info)
