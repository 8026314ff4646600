"""The torque that a motion takes, by the recursive Newton-Euler algorithm (Featherstone 2008, section 5.3)."""

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.kernel.arm import Arm
from airhockey.envs.kernel.compiling import compiled

Array = NDArray[np.float64]

GRAVITY = 9.81
"""Downwards, in [m/s²]."""


@compiled
def inverse_dynamics(
    arm: Arm, rotations: Array, velocity: Array, acceleration: Array, forces: Array, torque: Array
) -> None:
    """Write M(q) q̈ + c(q, q̇) + g(q) into `torque`, rotor inertia included.

    Args:
        rotations: From `link_rotations`. Shape (n, 3, 3).
        velocity, acceleration: Of the joints, in [rad/s] and [rad/s²]. Shape (n,).
        forces: Work space: force and moment on each link at its origin. Shape (n, 6).
        torque: Written, in [N·m]. Shape (n,).
    """
    n = velocity.shape[0]
    wx, wy, wz = 0.0, 0.0, 0.0  # angular velocity, in the link's axes
    dx, dy, dz = 0.0, 0.0, 0.0  # angular acceleration
    ax, ay, az = 0.0, 0.0, GRAVITY  # acceleration of the link's origin; the base "accelerates" upwards against gravity
    for i in range(n):
        px, py, pz = arm.offset[i, 0], arm.offset[i, 1], arm.offset[i, 2]
        ux, uy, uz = wy * pz - wz * py, wz * px - wx * pz, wx * py - wy * px
        lx = ax + dy * pz - dz * py + wy * uz - wz * uy
        ly = ay + dz * px - dx * pz + wz * ux - wx * uz
        lz = az + dx * py - dy * px + wx * uy - wy * ux
        r = rotations[i]
        ax = r[0, 0] * lx + r[1, 0] * ly + r[2, 0] * lz
        ay = r[0, 1] * lx + r[1, 1] * ly + r[2, 1] * lz
        az = r[0, 2] * lx + r[1, 2] * ly + r[2, 2] * lz
        vx = r[0, 0] * wx + r[1, 0] * wy + r[2, 0] * wz
        vy = r[0, 1] * wx + r[1, 1] * wy + r[2, 1] * wz
        vz = r[0, 2] * wx + r[1, 2] * wy + r[2, 2] * wz
        ex = r[0, 0] * dx + r[1, 0] * dy + r[2, 0] * dz
        ey = r[0, 1] * dx + r[1, 1] * dy + r[2, 1] * dz
        ez = r[0, 2] * dx + r[1, 2] * dy + r[2, 2] * dz
        rate = velocity[i]
        wx, wy, wz = vx, vy, vz + rate
        dx, dy, dz = ex + vy * rate, ey - vx * rate, ez + acceleration[i]
        cx, cy, cz = arm.center_of_mass[i, 0], arm.center_of_mass[i, 1], arm.center_of_mass[i, 2]
        ux, uy, uz = wy * cz - wz * cy, wz * cx - wx * cz, wx * cy - wy * cx
        mass = arm.mass[i]
        fx = mass * (ax + dy * cz - dz * cy + wy * uz - wz * uy)
        fy = mass * (ay + dz * cx - dx * cz + wz * ux - wx * uz)
        fz = mass * (az + dx * cy - dy * cx + wx * uy - wy * ux)
        m = arm.inertia[i]
        hx = m[0, 0] * wx + m[0, 1] * wy + m[0, 2] * wz
        hy = m[1, 0] * wx + m[1, 1] * wy + m[1, 2] * wz
        hz = m[2, 0] * wx + m[2, 1] * wy + m[2, 2] * wz
        forces[i, 0], forces[i, 1], forces[i, 2] = fx, fy, fz
        forces[i, 3] = m[0, 0] * dx + m[0, 1] * dy + m[0, 2] * dz + wy * hz - wz * hy + cy * fz - cz * fy
        forces[i, 4] = m[1, 0] * dx + m[1, 1] * dy + m[1, 2] * dz + wz * hx - wx * hz + cz * fx - cx * fz
        forces[i, 5] = m[2, 0] * dx + m[2, 1] * dy + m[2, 2] * dz + wx * hy - wy * hx + cx * fy - cy * fx
    for i in range(n - 1, -1, -1):
        torque[i] = forces[i, 5] + arm.armature[i] * acceleration[i]
        if i == 0:
            break
        r = rotations[i]
        fx = r[0, 0] * forces[i, 0] + r[0, 1] * forces[i, 1] + r[0, 2] * forces[i, 2]
        fy = r[1, 0] * forces[i, 0] + r[1, 1] * forces[i, 1] + r[1, 2] * forces[i, 2]
        fz = r[2, 0] * forces[i, 0] + r[2, 1] * forces[i, 1] + r[2, 2] * forces[i, 2]
        px, py, pz = arm.offset[i, 0], arm.offset[i, 1], arm.offset[i, 2]
        forces[i - 1, 0] += fx
        forces[i - 1, 1] += fy
        forces[i - 1, 2] += fz
        forces[i - 1, 3] += r[0, 0] * forces[i, 3] + r[0, 1] * forces[i, 4] + r[0, 2] * forces[i, 5] + py * fz - pz * fy
        forces[i - 1, 4] += r[1, 0] * forces[i, 3] + r[1, 1] * forces[i, 4] + r[1, 2] * forces[i, 5] + pz * fx - px * fz
        forces[i - 1, 5] += r[2, 0] * forces[i, 3] + r[2, 1] * forces[i, 4] + r[2, 2] * forces[i, 5] + px * fy - py * fx
