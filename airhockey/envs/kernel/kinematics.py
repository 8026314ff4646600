"""Where the arm is: link rotations, positions in the robot frame, Jacobian, and inverse kinematics."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.kernel.arm import Arm
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
def forward_kinematics(arm: Arm, joint_position: Array, positions: Array, axes: Array) -> None:
    """Positions of the links and the tip, and the joint axes, all in the robot frame.

    Args:
        joint_position: In [rad]. Shape (n,).
        positions: Written: origins of the links, then of the end-effector frame, in [m]. Shape (n + 1, 3).
        axes: Written: unit vectors of the joint axes, then the last link's x and y axes. Shape (n + 2, 3).
    """
    n = joint_position.shape[0]
    r00, r01, r02, r10, r11, r12, r20, r21, r22 = 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0
    x, y, z = 0.0, 0.0, 0.0
    for i in range(n):
        ox, oy, oz = arm.offset[i, 0], arm.offset[i, 1], arm.offset[i, 2]
        x += r00 * ox + r01 * oy + r02 * oz
        y += r10 * ox + r11 * oy + r12 * oz
        z += r20 * ox + r21 * oy + r22 * oz
        c, s = math.cos(joint_position[i]), math.sin(joint_position[i])
        m = arm.rotation[i]
        a00, a10, a20 = m[0, 0] * c + m[0, 1] * s, m[1, 0] * c + m[1, 1] * s, m[2, 0] * c + m[2, 1] * s
        a01, a11, a21 = m[0, 1] * c - m[0, 0] * s, m[1, 1] * c - m[1, 0] * s, m[2, 1] * c - m[2, 0] * s
        a02, a12, a22 = m[0, 2], m[1, 2], m[2, 2]
        b00, b01, b02 = (
            r00 * a00 + r01 * a10 + r02 * a20,
            r00 * a01 + r01 * a11 + r02 * a21,
            r00 * a02 + r01 * a12 + r02 * a22,
        )
        b10, b11, b12 = (
            r10 * a00 + r11 * a10 + r12 * a20,
            r10 * a01 + r11 * a11 + r12 * a21,
            r10 * a02 + r11 * a12 + r12 * a22,
        )
        b20, b21, b22 = (
            r20 * a00 + r21 * a10 + r22 * a20,
            r20 * a01 + r21 * a11 + r22 * a21,
            r20 * a02 + r21 * a12 + r22 * a22,
        )
        r00, r01, r02, r10, r11, r12, r20, r21, r22 = b00, b01, b02, b10, b11, b12, b20, b21, b22
        positions[i, 0], positions[i, 1], positions[i, 2] = x, y, z
        axes[i, 0], axes[i, 1], axes[i, 2] = r02, r12, r22
    tx, ty, tz = arm.tip[0], arm.tip[1], arm.tip[2]
    positions[n, 0] = x + r00 * tx + r01 * ty + r02 * tz
    positions[n, 1] = y + r10 * tx + r11 * ty + r12 * tz
    positions[n, 2] = z + r20 * tx + r21 * ty + r22 * tz
    axes[n, 0], axes[n, 1], axes[n, 2] = r00, r10, r20
    axes[n + 1, 0], axes[n + 1, 1], axes[n + 1, 2] = r01, r11, r21


@compiled
def point_jacobian(positions: Array, axes: Array, point: int, jacobian: Array) -> None:
    """Jacobian of a link's origin (or, with point n, of the tip) from what `forward_kinematics` wrote.

    Args:
        point: Index into `positions`; joints after it do not move it.
        jacobian: Written: derivative of the point's position, in [m/rad]. Shape (3, n).
    """
    for i in range(jacobian.shape[1]):
        dx, dy, dz = 0.0, 0.0, 0.0
        if i < point:
            dx = positions[point, 0] - positions[i, 0]
            dy = positions[point, 1] - positions[i, 1]
            dz = positions[point, 2] - positions[i, 2]
        jacobian[0, i] = axes[i, 1] * dz - axes[i, 2] * dy
        jacobian[1, i] = axes[i, 2] * dx - axes[i, 0] * dz
        jacobian[2, i] = axes[i, 0] * dy - axes[i, 1] * dx


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
