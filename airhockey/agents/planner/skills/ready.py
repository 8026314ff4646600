"""`ready`: the mallet goes to where it can answer most things, and waits."""

from collections.abc import Mapping
from math import hypot
from typing import Any

from airhockey.agents.planner.motion.driving import drive
from airhockey.agents.skill import Array, Situation
from airhockey.agents.table import HOME

FULL_SPEED = 0.8
"""Of the mallet on its way, in [m]/[s]."""
GAIN = 4.0
"""Speed per remaining distance, in [1/s]."""
SHARPNESS = 3.0
"""Largest change of the commanded velocity, in [m]/[s²]."""
ARRIVED = 0.02
"""In [m]."""


class Ready:
    """Goes to a place by a smooth, slow motion and stays there."""

    name = "ready"

    def __init__(self, env_info: Mapping[str, Any], place: Array = HOME) -> None:
        """Where to wait, in the table frame. Shape (2,)."""
        self._place = place
        self.phase = "return"
        self.finished = False

    def begin(self, situation: Situation) -> None:
        """See `Skill.begin`."""
        self.phase, self.finished = "return", False

    def act(self, situation: Situation) -> Array:
        """See `Skill.act`."""
        away = self._place - situation.tip
        distance = hypot(*away.tolist())
        self.finished = distance < ARRIVED
        self.phase = "wait" if self.finished else "return"
        return drive(situation, away * min(GAIN, FULL_SPEED / max(distance, 1e-9)), SHARPNESS)
