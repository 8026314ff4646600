def build_agent(env_info, **kwargs):
    """Replace this by the agent that you want to submit."""
    raise NotImplementedError
