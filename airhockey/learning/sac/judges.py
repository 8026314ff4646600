"""What training a skill is rewarded with: the thesis's reward of the task (4.9), in hundreds, and a shaping towards it."""

import numpy as np

from airhockey.agents.atacom.features import HORIZON, LINE, crossing
from airhockey.agents.atacom.skill import Situation
from airhockey.agents.estimation.motion import puck_motion
from airhockey.agents.table import HOME

SUCCESS, FAILURE = 10.0, 1.0
"""B and P of (4.9), in hundreds."""


class DefendJudge:
    """(4.9), less the speed that is left to the puck; before, a potential of the distance to where the puck will cross."""

    NEARNESS, CALM, DISCOUNT = 4.0, 2.0, 0.98

    def __init__(self) -> None:
        self._constants = puck_motion().constants

    def start(self, now: Situation) -> None:
        """See `Judge.start`."""
        self._potential = self._nearness(now)

    def step(self, now: Situation) -> float:
        """See `Judge.step`."""
        before, self._potential = self._potential, self._nearness(now)
        return self.DISCOUNT * self._potential - before

    def end(self, success: bool, now: Situation, violation: float) -> float:
        """See `Judge.end`."""
        speed = min(float(np.hypot(now.puck[2], now.puck[3])), 2.0)
        return (SUCCESS if success else -FAILURE) - violation - self.CALM * speed

    def _nearness(self, now: Situation) -> float:
        y = crossing(now.puck, LINE, HORIZON, self._constants)[1] if now.puck[0] > LINE else now.puck[1]
        return -self.NEARNESS * abs(float(y - now.tip[1]))


class HomeJudge:
    """Each step costs its distance from home; arriving is worth something."""

    def start(self, now: Situation) -> None:
        """See `Judge.start`."""

    def step(self, now: Situation) -> float:
        """See `Judge.step`."""
        return -float(np.hypot(*(HOME - now.tip)))

    def end(self, success: bool, now: Situation, violation: float) -> float:
        """See `Judge.end`."""
        return -violation


JUDGES = {"defend": DefendJudge, "home": HomeJudge}
