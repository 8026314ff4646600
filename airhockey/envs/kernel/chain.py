"""Positions in the robot frame and Jacobians of a serial arm: for the simulator, and for agents.

Nothing here knows MuJoCo: an agent may use it.
"""

import math
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.kernel.compiling import compiled

Array = NDArray[np.float64]


class SerialChain(Protocol):
    """A chain of n links that all turn about their own z axis: a named tuple with at least these fields."""

    @property
    def offset(self) -> Array:
        """Position of each link's origin in its parent's frame, in [m]. Shape (n, 3)."""

    @property
    def rotation(self) -> Array:
        """Orientation in the parent's frame at joint angle zero. Shape (n, 3, 3)."""

    @property
    def tip(self) -> Array:
        """Origin of the end-effector frame in the last link's frame, in [m]. Shape (3,)."""


@compiled
def forward_kinematics(arm: SerialChain, joint_position: Array, positions: Array, axes: Array) -> None:
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
