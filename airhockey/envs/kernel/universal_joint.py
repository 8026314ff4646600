"""The universal joint that keeps the iiwa's mallet level: the angles it should have, and the torques that drive it there."""

import math

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.kernel.compiling import compiled
from airhockey.envs.specs import STRIKER

Array = NDArray[np.float64]

_SOFT_RANGE = STRIKER.soft_range
_STIFFNESS = STRIKER.stiffness
_VISCOSITY = STRIKER.viscosity
_FILTER = STRIKER.filter


@compiled
def rod_axes(rotations: Array, axes: Array) -> None:
    """Write the x and y axes of the extension rod in the robot frame into `axes`, shape (2, 3)."""
    for k in range(2):
        x, y, z = (1.0, 0.0, 0.0) if k == 0 else (0.0, 1.0, 0.0)
        for i in range(rotations.shape[0] - 1, -1, -1):
            r = rotations[i]
            x, y, z = (
                r[0, 0] * x + r[0, 1] * y + r[0, 2] * z,
                r[1, 0] * x + r[1, 1] * y + r[1, 2] * z,
                r[2, 0] * x + r[2, 1] * y + r[2, 2] * z,
            )
        axes[k, 0], axes[k, 1], axes[k, 2] = x, y, z


@compiled
def desired_angles(axes: Array) -> tuple[float, float]:
    """Both hinge angles that would level the mallet, neither unwrapped nor clipped, in [rad].

    The second step squares the cross-product matrix element by element instead of as a matrix: a slip of the official
    package, kept because results are compared with it.

    Args:
        axes: x and y axes of the rod in the robot frame. Shape (2, 3).
    """
    x0, x1, x2 = axes[0, 0], axes[0, 1], axes[0, 2]
    y0, y1, y2 = axes[1, 0], axes[1, 1], axes[1, 2]
    # x_des = (-y1, y0, 0); (x × x_des) · y and x · x_des
    sine = (-x2 * y0) * y0 + (x2 * -y1) * y1 + (x0 * y0 + x1 * y1) * y2
    first = math.atan2(sine, -x0 * y1 + x1 * y0)
    s, c = math.sin(first), 1.0 - math.cos(first)
    u0 = x0 + (-y2 * s + y2 * y2 * c) * x1 + (y1 * s + y1 * y1 * c) * x2
    u1 = (y2 * s + y2 * y2 * c) * x0 + x1 + (-y0 * s + y0 * y0 * c) * x2
    u2 = (-y1 * s + y1 * y1 * c) * x0 + (y0 * s + y0 * y0 * c) * x1 + x2
    # y_des = (u1, -u0, 0); (y × y_des) · u and y · y_des
    sine = (y2 * u0) * u0 + (y2 * u1) * u1 + (-y0 * u0 - y1 * u1) * u2
    return first, math.atan2(sine, y0 * u1 - y1 * u0)


@compiled
def unwrap(angle: float, reference: float) -> float:
    """`angle`, moved by a full turn if that brings it within half a turn of `reference`."""
    if angle - reference > math.pi:
        return angle - 2.0 * math.pi
    if angle - reference < -math.pi:
        return angle + 2.0 * math.pi
    return angle


@compiled
def clip_angle(angle: float) -> float:
    """A desired angle within the joint's soft range, in [rad]."""
    return min(max(angle, -_SOFT_RANGE), _SOFT_RANGE)


@compiled
def striker_torque(desired: float, position: float, velocity: float, average: Array, index: int) -> float:
    """Torque of one hinge, in [N·m]; advances the filter of its velocity, `average[index]`, in [rad/s]."""
    average[index] = _FILTER * velocity + (1.0 - _FILTER) * average[index]
    return float(_STIFFNESS * (desired - position) - _VISCOSITY * average[index])
