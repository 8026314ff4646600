"""`learned`: tasks that networks were trained for from nothing by `hockey train ppo`, and `thesis-final` where there is none.

A network of the package is a folder `trained/<robot>-<task>`: network.npz, policy.yaml, and card.yaml, which says how it was
trained and what it reaches.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from airhockey.agents.base import AgentBase, task_of
from airhockey.agents.control.kinematics import spec_of
from airhockey.agents.learned.player import NETWORK, LearnedPlayer
from airhockey.agents.thesis.final import FinalThesisAgent

FOLDER = Path(__file__).parent / "trained"
"""The package's networks."""


def learned_agent(env_info: Mapping[str, Any], agent_id: int = 1, **kwargs: Any) -> AgentBase:
    """The player for an environment."""
    folder = FOLDER / f"{spec_of(env_info).n_joints}dof-{task_of(env_info)}"
    if (folder / NETWORK).exists():
        return LearnedPlayer.load(folder, env_info, agent_id=agent_id, **kwargs)
    return FinalThesisAgent(env_info, agent_id, **kwargs)
