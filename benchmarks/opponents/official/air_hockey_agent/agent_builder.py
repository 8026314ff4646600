"""The package's `ordinary` player, in the style of the official baseline, as an entry beside the other opponents."""

from typing import Any

from airhockey.agents.ordinary.agent import OrdinaryAgent


def build_agent(env_info: Any, **kwargs: Any) -> OrdinaryAgent:
    """See the challenge."""
    return OrdinaryAgent(env_info, **kwargs)
