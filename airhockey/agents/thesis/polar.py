"""The thesis's coordinates: where the end-effector is as seen from a centre, usually the puck (figure 4.1).

Angles are degrees in [0, 360), counter-clockwise, and 0 along a reference direction: the line from puck to goal in
the hit (γ), the table's x axis in prepare and home.
"""

from math import atan2, cos, degrees, hypot, radians, sin, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Polar(NamedTuple):
    """A point around a centre.

    Attributes:
        beta: β, angle from the reference direction, in [°], 0 ≤ β < 360.
        radius: r, in [m].
    """

    beta: float
    radius: float


def polar(center: Array, point: Array, gamma: float = 0.0) -> Polar:
    """Where a point is, seen from a centre.

    Args:
        center, point: In the same frame, in [m]. Shapes (2,), (2,).
        gamma: γ, the reference direction's own angle from the x axis, in [°].
    """
    x, y = (point - center).tolist()
    return Polar((degrees(atan2(y, x)) - gamma) % 360.0, hypot(x, y))


def cartesian(center: Array, place: Polar, gamma: float = 0.0) -> Array:
    """The point that `polar` describes. Shape (2,)."""
    angle = radians(place.beta + gamma)
    x, y = center.tolist()
    return np.array([x + place.radius * cos(angle), y + place.radius * sin(angle)])


def direction_angle(origin: Array, target: Array) -> float:
    """γ: the angle of the line from one point to another from the x axis, in [°], in (−180, 180]."""
    x, y = (target - origin).tolist()
    return degrees(atan2(y, x))


def wrapped(angle: float) -> float:
    """The same angle in [−180, 180), in [°]."""
    return (angle + 180.0) % 360.0 - 180.0


def limited_step(start: Array, target: Array, longest: float) -> Array:
    """The target, or the point on the way to it that is as far as a step may be. Shape (2,)."""
    way = target - start
    length = hypot(*way.tolist())
    return target if length <= longest else np.asarray(start + way * (longest / length))


def distance(here: Array, there: Array) -> float:
    """Between two points, in [m]. Shapes (2,), (2,)."""
    return hypot(*(here - there).tolist())


def stoppable_step(start: Array, target: Array, acceleration: float, dt: float) -> float:
    """The longest step, in [m], after which a motion can still stop at its target. Shapes (2,), (2,)."""
    return sqrt(2.0 * acceleration * distance(target, start)) * dt
