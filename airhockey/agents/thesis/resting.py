"""Where a puck lies that has come to rest, and whether it can be played from there: decided once, on the mean of what was seen.

Without it a puck at the border of what can be played is one thing in this step and another in the next, because of noise; or it
is held for playable where the task does not hold it for prepared.
"""

from math import hypot

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.thesis.policy import enough_space

Array = NDArray[np.float64]

ENOUGH = 25
"""Steps for which it must lie still."""
MOVED = 0.006
"""Distance from its mean place at which it has moved, in [m]: more than noise, and what 0.02 [m]/[s] make of those steps."""
ROLLING = 0.2
"""Speed at which it is rolling, whatever its places say, in [m]/[s]."""
SIDE, END = 0.003, 0.051
"""Of `enough_space`: |y| < 0.388 m, and x > −0.795 m, half a centimetre within what the task holds for prepared."""


class RestingPuck:
    """Fed with one estimate per control step.

    Attributes:
        playable: Whether a mallet has room behind the puck and the task holds it for prepared; None while it moves.
    """

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget the puck."""
        self._sum_x, self._sum_y, self._count = 0.0, 0.0, 0
        self.playable: bool | None = None

    def see(self, puck: PuckEstimate) -> None:
        """Take an estimate."""
        x, y, count = (
            float(puck.state[0]),
            float(puck.state[1]),
            self._count,
        )  # plain numbers: it is called in every step
        if puck.speed > ROLLING or (count > 0 and hypot(x - self._sum_x / count, y - self._sum_y / count) > MOVED):
            self.reset()
        if self.playable is None:
            self._sum_x, self._sum_y, self._count = self._sum_x + x, self._sum_y + y, self._count + 1
            if self._count >= ENOUGH:
                middle = np.array([self._sum_x, self._sum_y]) / self._count
                self.playable = enough_space(middle, SIDE, END)
