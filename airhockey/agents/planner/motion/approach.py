"""How the mallet gets to a place: briskly, to rest, and round the puck."""

from math import hypot, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.table import CONTACT

Array = NDArray[np.float64]

GAIN = 7.0
"""Speed per remaining distance close to the place, in [1/s]."""
FORESIGHT = 0.12
"""How far ahead the puck is kept clear of, in [s]."""


class Pace(NamedTuple):
    """How the mallet goes to a place.

    Attributes:
        speed, acceleration: Largest, in [m]/[s] and [m]/[s²].
        clearance: Gap to the puck, in [m].
    """

    speed: float
    acceleration: float
    clearance: float


def approach(
    tip: Array, velocity: Array, place: Array, pace: Pace, dt: float, keep_off: Array | None
) -> tuple[Array, Array]:
    """The next step of the mallet towards a place.

    Args:
        tip, velocity: Of the mallet, in [m], [m]/[s]. Shapes (2,), (2,).
        place: Where it shall come to rest. Shape (2,).
        pace: How it goes there.
        dt: In [s].
        keep_off: Centre of the puck to keep clear of, or None. Shape (2,).

    Returns:
        Position and velocity at the end of the step. Shapes (2,), (2,).
    """
    away = place - tip
    distance = hypot(*away.tolist())
    wanted = away * (
        min(pace.speed, GAIN * distance, 0.85 * sqrt(2.0 * pace.acceleration * distance)) / max(distance, 1e-9)
    )
    if keep_off is not None:
        wanted = _round(tip, wanted, place, keep_off, CONTACT + pace.clearance)
    change = wanted - velocity
    largest = pace.acceleration * dt
    moving = velocity + change * min(1.0, largest / max(hypot(*change.tolist()), 1e-9))
    return tip + 0.5 * dt * (velocity + moving), moving


def _round(tip: Array, wanted: Array, place: Array, puck: Array, distance: float) -> Array:
    """A velocity that slides along the circle about the puck instead of into it. Shape (2,)."""
    outwards = tip - puck
    gap = hypot(*outwards.tolist())
    outwards = outwards / max(gap, 1e-9)
    inwards = -float(wanted @ outwards)
    room = gap - distance
    allowed = max(GAIN * room, -0.3)  # at the circle: no further; inside: out of it
    if inwards <= allowed:
        return wanted
    along = np.array([-outwards[1], outwards[0]])
    goal = place - puck
    turn = 1.0 if outwards[0] * goal[1] - outwards[1] * goal[0] > 0.0 else -1.0  # the shorter way round
    slide = wanted + (inwards - allowed) * outwards
    return np.asarray(slide + 0.7 * (inwards - max(allowed, 0.0)) * turn * along)
