"""Finding the saves of a game in where puck and mallets were; the referee does not note them."""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.specs import MALLET, PUCK, TABLE

Array = NDArray[np.float64]
THREAT_SPEED = 0.8
"""Speed towards a goal from which a shot is a threat, in [m/s]."""
REACH = PUCK.radius + MALLET.radius + 0.04
"""Distance of the centres at which mallet and puck may have met between two steps, in [m]."""
AFTER = 4
"""Steps within which the mallet's touch shows, besides the one that touches."""
_APART = 50  # [steps] between two saves
_GOAL_WITHIN = 50  # [steps]: what goes in all the same was not saved


def threats(puck: Array, velocity: Array, side: float) -> NDArray[np.bool_]:
    """Whether the puck, if it slid on straight, would go into the goal of the player at `side`.

    Args:
        puck: Positions in the world, in [m]. Shape (T, 2).
        velocity: In [m/s]. Shape (T, 2).
        side: -1 for the player on the left, 1 for the one on the right.
    """
    towards = side * velocity[:, 0]
    time = (TABLE.length / 2 - side * puck[:, 0]) / np.maximum(towards, 1e-9)
    y = puck[:, 1] + velocity[:, 1] * time
    return (towards > THREAT_SPEED) & (side * puck[:, 0] > 0.0) & (np.abs(y) <= TABLE.goal_width / 2)


def saves(puck: Array, velocity: Array, mallets: Array, goals: Iterable[int] = ()) -> list[tuple[int, int, float]]:
    """Where a mallet took the puck off its way into the goal.

    A save is a threat that ends within a few steps at which puck and the defender's mallet meet, without a goal.

    Args:
        puck, velocity: At every step. Shapes (T, 2).
        mallets: Of both players, in [m]. Shape (T, 2, 2).
        goals: Steps (from 1) that ended with a goal.

    Returns:
        Step (from 1), player (0 or 1) and the shot's speed in [m/s] of each, in order.
    """
    found = []
    for k, side in enumerate((-1.0, 1.0)):
        threat = threats(puck, velocity, side)
        near = np.hypot(*(puck - mallets[:, k]).T) < REACH
        last = -_APART
        for t in np.flatnonzero(threat[:-1] & ~threat[1:]).tolist():
            touched = bool(near[max(t - 1, 0) : t + AFTER].any())
            if touched and t - last >= _APART and not _goal_follows(t, list(goals)):
                found.append((t + 2, k, float(np.hypot(*velocity[t]))))
                last = t
    return sorted(found)


def _goal_follows(t: int, goals: Sequence[int]) -> bool:
    return any(0 <= goal - 1 - t <= _GOAL_WITHIN for goal in goals)
