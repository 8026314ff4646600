"""The players that come with the package, by name."""

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from airhockey.agents.base import AgentBase
from airhockey.agents.settings import check, settings_in_use
from airhockey.errors import ConfigurationError

PLANAR_TASKS = ("3dof-hit", "3dof-defend")
IIWA_TASKS = ("7dof-hit", "7dof-defend", "7dof-prepare")
TASKS_OF_2025 = ("hit", "hit_single", "defend", "prepare")
EVERY_ENVIRONMENT = (*PLANAR_TASKS, *IIWA_TASKS, *TASKS_OF_2025, "tournament")
"""The names of all editions."""
CONTROL = {"control": "airhockey.agents.control.parameters:ControlParameters"}
RULES = {**CONTROL, "thesis": "airhockey.agents.thesis.parameters:ThesisSettings"}
"""What `--set` can change about players."""


@dataclass(frozen=True)
class AgentEntry:
    """A player that comes with the package.

    Attributes:
        name: What the user types.
        summary: One line for `hockey agents`.
        environments: Names of the environments that it can play.
        factory: Where it is made, "module:callable"; called with (env_info, agent_id, **kwargs).
        parts: What `--set` can change about it: a part -> where the dataclass of its parameters is, "module:class".
    """

    name: str
    summary: str
    environments: tuple[str, ...]
    factory: str
    parts: Mapping[str, str] = field(default_factory=lambda: CONTROL)

    def check_settings(self, settings: Sequence[str]) -> None:
        """Whether `--set` says what can be said of this player; raises `ConfigurationError`."""
        if settings:
            check(settings, {part: _imported(where) for part, where in self.parts.items()})

    def build(
        self, env_info: Mapping[str, Any], agent_id: int = 1, settings: Sequence[str] = (), **kwargs: Any
    ) -> AgentBase:
        """Import the factory and call it; `settings` change the player's parameters, see `airhockey.agents.settings`."""
        self.check_settings(settings)
        with settings_in_use(settings):
            agent = _imported(self.factory)(env_info, agent_id=agent_id, **kwargs)
        if not isinstance(agent, AgentBase):
            raise ConfigurationError(f"{self.factory} did not return an agent but {type(agent).__name__}")
        return agent


def _imported(where: str) -> Any:
    module, _, attribute = where.partition(":")
    return getattr(importlib.import_module(module), attribute)


AGENTS: dict[str, AgentEntry] = {
    entry.name: entry
    for entry in (
        AgentEntry(
            "hold",
            "stands still where the serve finds it",
            EVERY_ENVIRONMENT,
            "airhockey.agents.hold:HoldAgent",
        ),
        AgentEntry(
            "person",
            "you, by mouse or finger, at `hockey play`; where nobody points, it goes home and stays there",
            EVERY_ENVIRONMENT,
            "airhockey.agents.person:PersonAgent",
        ),
        AgentEntry(
            "thesis",
            "rule-based: hit, defend, prepare, home; switcher and state machine (parameters in YAML)",
            EVERY_ENVIRONMENT,
            "airhockey.agents.thesis.agent:ThesisAgent",
            RULES,
        ),
        AgentEntry(
            "thesis-final",
            "the thesis's last player: hit and prepare by rules; defend and home by SAC on ATACOM (iiwa; planar: rules)",
            EVERY_ENVIRONMENT,
            "airhockey.agents.thesis.final:FinalThesisAgent",
            RULES,
        ),
        AgentEntry(
            "ordinary",
            "an opponent in the style of the official baseline: meets pucks on a line, foresees no bounce, shoots straight",
            EVERY_ENVIRONMENT,
            "airhockey.agents.ordinary.agent:OrdinaryAgent",
        ),
        AgentEntry(
            "learned",
            "defend by a network that PPO trained from nothing under constraints (iiwa); the rest as thesis-final",
            EVERY_ENVIRONMENT,
            "airhockey.agents.learned.agent:learned_agent",
        ),
        AgentEntry(
            "planner",
            "planning: predicts the puck and chooses among smash, defend, repel, prepare and ready",
            EVERY_ENVIRONMENT,
            "airhockey.agents.planner.agent:PlannerAgent",
        ),
    )
}
