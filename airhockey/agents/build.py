"""How a player is built, from a name of the registry or from a submission's folder."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from airhockey.agents.base import AgentBase
from airhockey.agents.registry import AGENTS
from airhockey.agents.submission import build_submission
from airhockey.errors import unknown


def build_agent(name_or_path: str | Path, env_info: Mapping[str, Any], agent_id: int = 1, **kwargs: Any) -> AgentBase:
    """Build a player.

    Args:
        name_or_path: A key of `AGENTS`, or the folder of a submission: one that holds `agent_builder.py`, or has a
            sub-folder `air_hockey_agent/` that does.
        env_info: Description of the environment, handed to the agent.
        agent_id: 1 for the left robot, 2 for the right one.
        kwargs: Handed to the agent; they win over a submission's `agent_config.yml`.

    Raises:
        ConfigurationError: Neither a known name nor a folder with a usable `agent_builder.py`.
    """
    name = str(name_or_path)
    if name in AGENTS:
        return AGENTS[name].build(env_info, agent_id, **kwargs)
    path = Path(name_or_path).expanduser()
    if path.exists() or "/" in name or name.startswith("."):
        agent: AgentBase = build_submission(path, env_info, agent_id, **kwargs)
        return agent
    raise unknown("agent", name, (*AGENTS, "or the path of a submission folder"))
