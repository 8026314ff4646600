"""Where the arm is, for the simulator: link rotations, work space, and the official inverse kinematics."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.kernel.arm import Arm
from airhockey.envs.kernel.chain import forward_kinematics, point_jacobian
from airhockey.envs.kernel.compiling import compiled

Array = NDArray[np.float64]

SOFT_RANGE = 0.95
"""Inverse kinematics keeps joints within this share of their range."""
_DAMPING = 1e-3
_MAX_STEP = 0.1
_TOLERANCE = 1e-4
_MAX_ITERATIONS = 1000
_GIVE_UP = 20.0


class WorkSpace(NamedTuple):
    """Arrays that inverse kinematics writes to: compiled functions here allocate nothing."""

    positions: Array
    axes: Array
    jacobian: Array
    step: Array
    error: Array


def work_space(n: int) -> WorkSpace:
    """Work space for an arm of n joints."""
    return WorkSpace(np.empty((n + 1, 3)), np.empty((n + 2, 3)), np.empty((3, n)), np.empty(n), np.empty(3))


@compiled
def link_rotations(arm: Arm, joint_position: Array, rotations: Array) -> None:
    """Write each link's orientation in its parent's frame into `rotations`, shape (n, 3, 3)."""
    for i in range(joint_position.shape[0]):
        c, s = math.cos(joint_position[i]), math.sin(joint_position[i])
        for row in range(3):
            x, y = arm.rotation[i, row, 0], arm.rotation[i, row, 1]
            rotations[i, row, 0] = x * c + y * s
            rotations[i, row, 1] = y * c - x * s
            rotations[i, row, 2] = arm.rotation[i, row, 2]


@compiled
def damped_solve(jacobian: Array, error: Array, damping: float, step: Array) -> None:
    """Write (JᵀJ + damping·I)⁻¹ Jᵀ e into `step`, as Jᵀ (JJᵀ + damping·I)⁻¹ e: a 3×3 system instead of n×n."""
    n = step.shape[0]
    a, b, c, d, e, f = damping, 0.0, 0.0, damping, 0.0, damping
    for i in range(n):
        x, y, z = jacobian[0, i], jacobian[1, i], jacobian[2, i]
        a += x * x
        b += x * y
        c += x * z
        d += y * y
        e += y * z
        f += z * z
    m00, m01, m02 = d * f - e * e, c * e - b * f, b * e - c * d
    m11, m12, m22 = a * f - c * c, b * c - a * e, a * d - b * b
    determinant = a * m00 + b * m01 + c * m02
    u = (m00 * error[0] + m01 * error[1] + m02 * error[2]) / determinant
    v = (m01 * error[0] + m11 * error[1] + m12 * error[2]) / determinant
    w = (m02 * error[0] + m12 * error[1] + m22 * error[2]) / determinant
    for i in range(n):
        step[i] = jacobian[0, i] * u + jacobian[1, i] * v + jacobian[2, i] * w


@compiled
def inverse_kinematics(arm: Arm, target: Array, joint_position: Array, work: WorkSpace) -> bool:
    """Move `joint_position` until the tip is at `target`, by damped least squares; False when it gave up.

    Args:
        target: Position of the tip in the robot frame, in [m]. Shape (3,).
        joint_position: Start, overwritten with the solution or the last iterate, in [rad]. Shape (n,).
        work: From `work_space(n)`.
    """
    n = joint_position.shape[0]
    positions, axes, jacobian, step, error = work.positions, work.axes, work.jacobian, work.step, work.error
    for _ in range(_MAX_ITERATIONS):
        forward_kinematics(arm, joint_position, positions, axes)
        for k in range(3):
            error[k] = target[k] - positions[n, k]
        distance = math.sqrt(error[0] ** 2 + error[1] ** 2 + error[2] ** 2)
        if distance < _TOLERANCE:
            return True
        point_jacobian(positions, axes, n, jacobian)
        damped_solve(jacobian, error, _DAMPING, step)
        length = 0.0
        for i in range(n):
            length += step[i] * step[i]
        length = math.sqrt(length)
        if distance > _GIVE_UP * length:
            return False
        scale = _MAX_STEP / length if length > _MAX_STEP else 1.0
        for i in range(n):
            lower, upper = SOFT_RANGE * arm.position_limit[0, i], SOFT_RANGE * arm.position_limit[1, i]
            joint_position[i] = min(max(joint_position[i] + scale * step[i], lower), upper)
    return False
