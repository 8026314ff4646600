"""Players of robot air hockey: they see `env_info` and observations, and answer with joint commands.

    from airhockey.agents import AGENTS, build_agent
    agent = build_agent("thesis", env_info)

`AGENTS` lists the players that come with the package; `build_agent` also takes the folder of a submission.
Nothing heavy is imported before an agent is built.
"""

from typing import TYPE_CHECKING, Any

from airhockey.lazy import attribute

if TYPE_CHECKING:
    from airhockey.agents.base import AgentBase
    from airhockey.agents.build import build_agent
    from airhockey.agents.registry import AGENTS, AgentEntry

__all__ = ["AGENTS", "AgentBase", "AgentEntry", "build_agent"]

_HOMES = {
    "AGENTS": "airhockey.agents.registry",
    "AgentBase": "airhockey.agents.base",
    "AgentEntry": "airhockey.agents.registry",
    "build_agent": "airhockey.agents.build",
}


def __getattr__(name: str) -> Any:
    """Import what the layer offers when it is first asked for (PEP 562)."""
    return attribute(__name__, name, _HOMES)
