"""Whether a slow puck lies still, and where it will lie soon: a straight line through its last positions.

The filter's velocity is noisy against speeds of a few cm/s; a fifth of a second of positions tells them apart.
"""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.estimation.motion import puck_motion

Array = NDArray[np.float64]

NOISE = 0.0015
"""Standard deviation of a filtered position, in [m], neighbours not being independent."""
SURE = 4.0
"""A velocity of fewer standard deviations than this is none."""


class RestDetection:
    """Fed with one estimated position per control step."""

    def __init__(self, dt: float, least: int = 10, length: int = 40) -> None:
        """Remember the last positions.

        Args:
            dt: Length of a control step, in [s].
            least: How many positions it takes to tell anything.
            length: How many are remembered.
        """
        self._dt = dt
        self._least = least
        self._decay = float(puck_motion().constants[3])
        self._seen: deque[Array] = deque(maxlen=length)

    def reset(self) -> None:
        """Forget the puck."""
        self._seen.clear()

    def see(self, position: Array) -> None:
        """Take a position, in [m]. Shape (2,)."""
        self._seen.append(np.array(position))

    @property
    def ready(self) -> bool:
        """Whether there are enough positions to tell."""
        return len(self._seen) >= self._least

    def motion(self) -> tuple[Array, Array]:
        """Position [m] and velocity [m]/[s] now, by least squares. Shapes (2,), (2,)."""
        seen = np.array(self._seen)
        ages = self._dt * (np.arange(len(seen)) - (len(seen) - 1))
        centre = ages.mean()
        spread = max(float(((ages - centre) ** 2).sum()), 1e-9)
        velocity = (ages - centre) @ seen / spread
        if np.hypot(*velocity) < SURE * NOISE / np.sqrt(spread):
            return np.asarray(seen.mean(axis=0)), np.zeros(2)
        return np.asarray(seen.mean(axis=0) - centre * velocity), np.asarray(velocity)

    def after(self, time: float) -> Array:
        """Where the puck will be after a time, in [s]. Shape (2,)."""
        position, velocity = self.motion()
        return position + velocity * (1.0 - float(np.exp(-self._decay * time))) / self._decay
