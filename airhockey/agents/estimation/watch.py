"""From an observation to what a player knows: the puck filtered, and where the opponent's mallet is."""

from collections.abc import Mapping
from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.estimation.kalman import Noise, PuckEstimate, PuckFilter
from airhockey.agents.table import BASE_X, CONTACT

Array = NDArray[np.float64]

NEAR = 0.012
"""Gap between puck and mallet, in [m], at which they may be touching within a step."""


class TableWatch:
    """Reads one observation per control step; everything it says is in the table frame."""

    def __init__(self, env_info: Mapping[str, Any], noise: Noise | None = None) -> None:
        """Set up the filter.

        Args:
            env_info: Description of the environment.
            noise: What the filter assumes.
        """
        self._filter = PuckFilter(float(env_info["dt"]), noise)
        self._puck = np.array([*env_info["puck_pos_ids"][:2], *env_info["puck_vel_ids"]], dtype=np.int64)
        self._opponent = np.array(env_info["opponent_ee_ids"], dtype=np.int64)
        self.see(np.zeros(int(self._puck.max()) + 1), np.zeros(2))  # compile before the game
        self.reset()

    def reset(self) -> None:
        """A new serve: forget the puck."""
        self._filter.reset()

    def see(self, observation: Array, tip: Array) -> tuple[PuckEstimate, Array | None]:
        """The puck now, and the opponent's mallet, (2,), or None where there is no opponent.

        Args:
            observation: In the robot frame. Shape (d,).
            tip: Commanded position of the rod tip, in the table frame, in [m]. Shape (2,).
        """
        puck, opponent, touching = read(observation, self._puck, self._opponent, tip)
        return self._filter.take(puck, touching), opponent if len(opponent) else None


@compiled
def read(
    observation: Array, puck_ids: NDArray[np.int64], opponent_ids: NDArray[np.int64], tip: Array
) -> tuple[Array, Array, bool]:
    """Puck (5,), opponent's mallet (2,) or (0,), and whether a mallet may be touching the puck."""
    puck = np.empty(5)
    for i in range(5):
        puck[i] = observation[puck_ids[i]]
    puck[0] += BASE_X
    seen = len(opponent_ids) > 0 and opponent_ids.max() < len(observation)
    opponent = np.empty(2 if seen else 0)
    touching = _close(puck, tip)
    if seen:
        opponent[0], opponent[1] = observation[opponent_ids[0]] + BASE_X, observation[opponent_ids[1]]
        touching = touching or _close(puck, opponent)
    return puck, opponent, touching


@compiled
def _close(puck: Array, mallet: Array) -> bool:
    return sqrt((puck[0] - mallet[0]) ** 2 + (puck[1] - mallet[1]) ** 2) < CONTACT + NEAR
