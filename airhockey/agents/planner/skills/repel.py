"""`repel`: knock an incoming puck back at the opponent's goal.

The meeting is planned as in `defend`; only what the puck shall do after it differs.

Phases: those of `defend`; the skill is finished once the puck is on its way back.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from airhockey.agents.planner.skills.defend import Defend
from airhockey.agents.skill import Array, Situation


class Repel(Defend):
    """A defence that returns what it meets."""

    name = "repel"

    def __init__(self, env_info: Mapping[str, Any], parameters: str | Path = "repel") -> None:
        """Load the parameters and compile.

        Args:
            env_info: Description of the environment.
            parameters: Name or path of a YAML file, with the keys of `defend.yaml`.

        Raises:
            ConfigurationError: The file is not usable.
        """
        super().__init__(env_info, parameters)
        self._done = False

    @property
    def finished(self) -> bool:
        """Whether the puck is on its way back, or needs no answer."""
        return self._done or super().finished

    def begin(self, situation: Situation) -> None:
        """See `Skill.begin`."""
        super().begin(situation)
        self._done = False

    def act(self, situation: Situation) -> Array:
        """See `Skill.act`."""
        self._done = self.phase != "catch" and situation.puck.velocity[0] > self._parameters.overtake_speed
        return super().act(situation)
