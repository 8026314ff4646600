"""Our `thesis` as a submission: it also runs in the official evaluator beside which airhockey is installed."""

from airhockey.agents import build_agent as build


def build_agent(env_info, **kwargs):
    """What an evaluator calls; `kwargs` are keys of `agent_config.yml`, and `agent_id` in a tournament."""
    return build("thesis", env_info, **kwargs)
