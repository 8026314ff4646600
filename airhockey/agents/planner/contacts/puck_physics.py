"""A puck among a mallet and the rims, contact by contact: the simulator's own soft contacts, for one disc in the plane.

It is for short times in which a puck touches several things at once; `estimation.motion` is the faster law for free flight.
The contact model is MuJoCo's: with impedance d, an active contact asks for the acceleration −b v − k d r along its normal (r < 0
is the gap) and −b v along its tangent; forces f solve (J M⁻¹ Jᵀ + R) f = a_ref, f_n ≥ 0, |f_t| ≤ μ f_n, with R = (1 − d)/d · w.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.envs.specs import MALLET, PUCK, TABLE

Array = NDArray[np.float64]

TIME_STEP = 0.001
"""The simulator's, in [s]. The rims are so stiff that a bounce depends on it."""
_RADIUS, _TOUCH = PUCK.radius, PUCK.radius + MALLET.radius
_HALF_X, _HALF_Y, _GOAL = TABLE.length / 2 - PUCK.radius, TABLE.width / 2 - PUCK.radius, TABLE.goal_width / 2
_INVERSE_MASS, _INVERSE_INERTIA = 1.0 / PUCK.mass, 1.0 / PUCK.inertia[2]
_KEEP = 1.0 / (1.0 + TIME_STEP * PUCK.slide_damping / PUCK.mass)
_KEEP_SPIN = 1.0 / (1.0 + TIME_STEP * PUCK.yaw_damping / PUCK.inertia[2])
_WEIGHT = 2.0 / 3.0 * _INVERSE_MASS  # MuJoCo's w: the mean of three axes, one of which the puck cannot move along
_SWEEPS = 12

# solref (time constant, damping ratio), solimp (least and largest impedance), friction: challenge's section 1
_MALLET_CONTACT = (0.02, 0.3, 0.9, 0.95)
_RIM_CONTACT = (0.0075, 0.1, 0.99, 0.999)
_RIM_FRICTION = 1e4


class Mallet(NamedTuple):
    """Centre of a mallet, in [m], and how it moves, in [m]/[s]."""

    x: float
    y: float
    velocity_x: float
    velocity_y: float


class Contacts(NamedTuple):
    """What touches a puck.

    Attributes:
        normals: Unit vectors to the puck. Shape (3, 2).
        gaps: Negative where they overlap, in [m]. Shape (3,).
        moving: Velocity of what it touches, in [m]/[s]. Shape (3, 2).
        mallet: Whether the first is the mallet's.
        rows: How many of the rows count.
    """

    normals: Array
    gaps: Array
    moving: Array
    mallet: bool
    rows: int


@compiled
def step(puck: Array, mallet: Mallet, friction: float, rim: float) -> bool:
    """Advance a puck by `TIME_STEP`, in place.

    Args:
        puck: x, y [m], ẋ, ẏ [m]/[s], yaw rate [rad]/[s], in the table frame. Shape (5,).
        mallet: Where it is.
        friction: μ between mallet and puck.
        rim: Damping ratio of the rims, as a multiple of the nominal one.

    Returns:
        Whether the mallet touched the puck.
    """
    away_x, away_y = puck[0] - mallet.x, puck[1] - mallet.y
    touched = away_x * away_x + away_y * away_y < _TOUCH * _TOUCH
    end = abs(puck[0]) > _HALF_X and abs(puck[1]) > _GOAL
    side = abs(puck[1]) > _HALF_Y
    if touched or end or side:
        normals, gaps, moving = np.empty((3, 2)), np.empty(3), np.zeros((3, 2))
        count = 0
        if touched:
            distance = math.sqrt(away_x * away_x + away_y * away_y)
            normals[0, 0], normals[0, 1] = away_x / distance, away_y / distance
            moving[0, 0], moving[0, 1], gaps[0] = mallet.velocity_x, mallet.velocity_y, distance - _TOUCH
            count = 1
        if end:
            normals[count, 0], normals[count, 1] = -math.copysign(1.0, puck[0]), 0.0
            gaps[count] = _HALF_X - abs(puck[0])
            count += 1
        if side:
            normals[count, 0], normals[count, 1] = 0.0, -math.copysign(1.0, puck[1])
            gaps[count] = _HALF_Y - abs(puck[1])
            count += 1
        _push(puck, Contacts(normals, gaps, moving, touched, count), friction, rim)
    puck[2] *= _KEEP
    puck[3] *= _KEEP
    puck[4] *= _KEEP_SPIN
    puck[0] += TIME_STEP * puck[2]
    puck[1] += TIME_STEP * puck[3]
    return bool(touched)


@compiled
def clearance(puck: Array, mallet_x: float, mallet_y: float) -> float:
    """The gap to the nearest thing that a puck could touch, in [m]; negative inside it."""
    mallet = math.hypot(puck[0] - mallet_x, puck[1] - mallet_y) - _TOUCH
    return float(min(mallet, _HALF_X - abs(puck[0]), _HALF_Y - abs(puck[1])))


@compiled
def put_on_table(puck: Array, gap: float) -> None:
    """Move a puck that is believed to lie within a rim out of it, in place, to a gap in [m]."""
    puck[0] = max(puck[0], -_HALF_X + gap)
    puck[1] = min(max(puck[1], -_HALF_Y + gap), _HALF_Y - gap)


@compiled
def _push(puck: Array, contacts: Contacts, friction: float, rim: float) -> None:
    """Add what the contacts do to the velocities: projected Gauss–Seidel over the forces."""
    normals, gaps, moving, touched, count = contacts
    wanted, soft, forces = np.empty((3, 2)), np.empty(3), np.zeros((3, 2))
    for c in range(count):
        time_constant, ratio, low, high = _MALLET_CONTACT if (touched and c == 0) else _RIM_CONTACT
        if not (touched and c == 0):
            ratio *= rim
        d = low + (high - low) * _share(-gaps[c] / 0.001)
        b = 2.0 / (high * time_constant)
        k = 1.0 / (high * time_constant * ratio) ** 2
        soft[c] = (1.0 - d) / d * _WEIGHT
        nx, ny = normals[c, 0], normals[c, 1]
        vx, vy = puck[2] - moving[c, 0], puck[3] - moving[c, 1]
        wanted[c, 0] = -b * (vx * nx + vy * ny) - k * d * gaps[c]
        wanted[c, 1] = -b * (-vx * ny + vy * nx - _RADIUS * puck[4])
    ax = ay = spin = 0.0
    a_n, a_t = _INVERSE_MASS, _INVERSE_MASS + _RADIUS * _RADIUS * _INVERSE_INERTIA
    for _ in range(1 if count == 1 else _SWEEPS):  # normal and tangent of one contact do not see each other
        for c in range(count):
            nx, ny = normals[c, 0], normals[c, 1]
            limit = friction if (touched and c == 0) else _RIM_FRICTION
            have = ax * nx + ay * ny
            f = max(0.0, forces[c, 0] + (wanted[c, 0] - have - soft[c] * forces[c, 0]) / (a_n + soft[c]))
            change = (f - forces[c, 0]) * _INVERSE_MASS
            ax += change * nx
            ay += change * ny
            forces[c, 0] = f
            have = -ax * ny + ay * nx - _RADIUS * spin
            f = forces[c, 1] + (wanted[c, 1] - have - soft[c] * forces[c, 1]) / (a_t + soft[c])
            f = min(max(f, -limit * forces[c, 0]), limit * forces[c, 0])
            change = f - forces[c, 1]
            ax -= change * _INVERSE_MASS * ny
            ay += change * _INVERSE_MASS * nx
            spin -= change * _RADIUS * _INVERSE_INERTIA
            forces[c, 1] = f
    puck[2] += TIME_STEP * ax
    puck[3] += TIME_STEP * ay
    puck[4] += TIME_STEP * spin


@compiled
def _share(x: float) -> float:
    """MuJoCo's impedance law: a smooth step from 0 to 1, with power 2 about the midpoint."""
    if x >= 1.0:
        return 1.0
    if x <= 0.0:
        return 0.0
    return 2.0 * x * x if x <= 0.5 else 1.0 - 2.0 * (1.0 - x) * (1.0 - x)
