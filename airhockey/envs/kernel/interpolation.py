"""From one action to the set-points of the 20 simulation steps.

A polynomial in time leads each joint from the previous *command* (never the measured state) to the action, and its value and
derivatives at the end become the next previous command. `order` follows the official package: 1 linear, 2 quadratic, 3 cubic,
4 quartic, 5 quintic, -1 position and velocity each linear.
"""

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.kernel.compiling import compiled
from airhockey.envs.specs import ACCELERATION, CONTROL_PERIOD, POSITION, SUBSTEPS, TIMESTEP, VELOCITY

Array = NDArray[np.float64]

WHOLE_TRAJECTORY = 0
"""Stands for the order `None`: the action is the set-points themselves."""
_STANDSTILL = 1e-3  # order 2: a shorter step (norm over the joints, in rad) starts from rest
_T = CONTROL_PERIOD


@compiled
def interpolate(order: int, action: Array, command: Array, set_points: Array, jerk: Array) -> None:
    """Write the set-points of one control step and advance the previous command.

    Args:
        order: As in this module's docstring, or `WHOLE_TRAJECTORY`.
        action: Rows of position, velocity and acceleration, as many as the order takes; shape (1 to 3, n). With
            `WHOLE_TRAJECTORY` the 20 set-points, flattened to shape (60, n).
        command: Previous position, velocity, acceleration; overwritten by this action's end. Shape (3, n).
        set_points: Written: position, velocity, acceleration at 1 … 20 ms. Shape (20, 3, n).
        jerk: Written: the jerk that the official package reports, in [rad/s³]. Shape (n,).
    """
    n = command.shape[1]
    if order == WHOLE_TRAJECTORY:
        for k in range(SUBSTEPS):
            for row in range(3):
                for i in range(n):
                    set_points[k, row, i] = action[3 * k + row, i]
        jerk[:] = 0.0
        return
    at_rest = False
    if order == 2:
        distance = 0.0
        for i in range(n):
            distance += (action[POSITION, i] - command[POSITION, i]) ** 2
        at_rest = distance**0.5 < _STANDSTILL
    for i in range(n):
        p0, v0, a0 = command[POSITION, i], command[VELOCITY, i], command[ACCELERATION, i]
        if order == -1:
            _interpolate_separately(action, i, command, set_points)
            jerk[i] = np.inf
            continue
        if at_rest:
            v0 = 0.0
        c1, c2, c3, c4, c5 = _coefficients(order, action, i, p0, v0, a0)
        for k in range(SUBSTEPS):
            t = (k + 1) * TIMESTEP
            set_points[k, POSITION, i] = p0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * c5))))
            set_points[k, VELOCITY, i] = c1 + t * (2 * c2 + t * (3 * c3 + t * (4 * c4 + t * 5 * c5)))
            set_points[k, ACCELERATION, i] = 2 * c2 + t * (6 * c3 + t * (12 * c4 + t * 20 * c5))
        jerk[i] = abs(6 * c3) + abs(2 * c2 - a0) / TIMESTEP if order >= 3 else np.inf
        for row in range(3):
            command[row, i] = set_points[SUBSTEPS - 1, row, i]


@compiled
def _coefficients(
    order: int, action: Array, i: int, p0: float, v0: float, a0: float
) -> tuple[float, float, float, float, float]:
    """Coefficients of t … t⁵ for joint i; the constant one is p0."""
    step = action[POSITION, i] - p0
    if order == 1:
        return step / _T, 0.0, 0.0, 0.0, 0.0
    if order == 2:
        return v0, (step - v0 * _T) / _T**2, 0.0, 0.0, 0.0
    v1 = action[VELOCITY, i]
    if order == 3:
        return v0, (3 * step - (2 * v0 + v1) * _T) / _T**2, ((v0 + v1) * _T - 2 * step) / _T**3, 0.0, 0.0
    position_gap = step - v0 * _T - 0.5 * a0 * _T**2
    velocity_gap = v1 - v0 - a0 * _T
    if order == 4:
        c3 = (4 * position_gap - velocity_gap * _T) / _T**3
        return v0, 0.5 * a0, c3, (velocity_gap * _T - 3 * position_gap) / _T**4, 0.0
    acceleration_gap = action[ACCELERATION, i] - a0
    c3 = (10 * position_gap - 4 * velocity_gap * _T + 0.5 * acceleration_gap * _T**2) / _T**3
    c4 = (-15 * position_gap + 7 * velocity_gap * _T - acceleration_gap * _T**2) / _T**4
    c5 = (6 * position_gap - 3 * velocity_gap * _T + 0.5 * acceleration_gap * _T**2) / _T**5
    return v0, 0.5 * a0, c3, c4, c5


@compiled
def _interpolate_separately(action: Array, i: int, command: Array, set_points: Array) -> None:
    """Order -1 of joint i: velocity is not the derivative of position, by design of the official package."""
    p0, v0 = command[POSITION, i], command[VELOCITY, i]
    p1, v1 = action[POSITION, i], action[VELOCITY, i]
    acceleration = (v1 - v0) / _T
    for k in range(SUBSTEPS):
        t = (k + 1) * TIMESTEP
        set_points[k, POSITION, i] = p0 + (p1 - p0) / _T * t
        set_points[k, VELOCITY, i] = v0 + acceleration * t
        set_points[k, ACCELERATION, i] = acceleration
    command[POSITION, i], command[VELOCITY, i], command[ACCELERATION, i] = p1, v1, acceleration
