"""From a set-point to motor torques: safety limiter and feed-forward PD controller; and the velocity filter."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.kernel.arm import Arm
from airhockey.envs.kernel.compiling import compiled
from airhockey.envs.kernel.dynamics import inverse_dynamics
from airhockey.envs.kernel.kinematics import link_rotations
from airhockey.envs.kernel.plant import Plant
from airhockey.envs.kernel.universal_joint import clip_angle, desired_angles, rod_axes, striker_torque, unwrap
from airhockey.envs.specs import ACCELERATION, JOINT_VELOCITY_FILTER, POSITION, STRIKER, SUBSTEPS, TIMESTEP, VELOCITY

Array = NDArray[np.float64]

_LIMITER_GAIN = 20.0  # [1/s]
_STRIKER_TORQUE = STRIKER.torque_limit


class Controller(NamedTuple):
    """What the controllers of the R robots remember between steps.

    Attributes:
        command: Previous commanded position, velocity, acceleration. Shape (R, 3, n).
        clipped: Last clipped position command. Shape (R, n).
        velocity: Filtered joint velocity. Shape (R, n).
        striker_average: Filtered velocity of the universal joint. Shape (R, 2).
        striker_seen: Robot 1's universal joint at the beginning of the previous substep, zero after a reset. Shape (2,).
        set_points: Of this control step. Shape (R, 20, 3, n).
        rotations, forces, torque, rod: Work space.
    """

    command: Array
    clipped: Array
    velocity: Array
    striker_average: Array
    striker_seen: Array
    set_points: Array
    rotations: Array
    forces: Array
    torque: Array
    rod: Array


def new_controller(robots: int, n: int) -> Controller:
    """The memory of controllers of arms with n joints, all zero."""
    return Controller(
        command=np.zeros((robots, 3, n)),
        clipped=np.zeros((robots, n)),
        velocity=np.zeros((robots, n)),
        striker_average=np.zeros((robots, 2)),
        striker_seen=np.zeros(2),
        set_points=np.zeros((robots, SUBSTEPS, 3, n)),
        rotations=np.zeros((n, 3, 3)),
        forces=np.zeros((n, 6)),
        torque=np.zeros(n),
        rod=np.zeros((2, 3)),
    )


@compiled
def limit_set_point(arm: Arm, set_point: Array, clipped: Array) -> None:
    """Keep a set-point inside the position and velocity limits, approaching a position limit ever more slowly.

    Args:
        set_point: Position, velocity and acceleration; position and velocity are clipped in place. Shape (3, n).
        clipped: The last clipped position command, in [rad]; overwritten by this one. Shape (n,).
    """
    for i in range(clipped.shape[0]):
        lowest, highest = arm.velocity_limit[0, i], arm.velocity_limit[1, i]
        p = clipped[i]
        slowest = min(max(-_LIMITER_GAIN * (p - arm.position_limit[0, i]), lowest), highest)
        fastest = min(max(-_LIMITER_GAIN * (p - arm.position_limit[1, i]), lowest), highest)
        set_point[VELOCITY, i] = min(max(set_point[VELOCITY, i], slowest), fastest)
        wish = set_point[POSITION, i]
        set_point[POSITION, i] = min(max(wish, p + slowest * TIMESTEP), p + fastest * TIMESTEP)
        clipped[i] = set_point[POSITION, i]


@compiled
def add_feedback(arm: Arm, set_point: Array, position: Array, velocity: Array, torque: Array) -> None:
    """Add the PD controller's part to the feed-forward `torque` (thesis, equation 3.1), in [N·m]; nothing is clipped yet.

    Args:
        set_point: Position, velocity, acceleration. Shape (3, n).
        position: Measured, in [rad]. Shape (n,).
        velocity: Filtered, in [rad/s]. Shape (n,).
        torque: What the motion itself takes (`inverse_dynamics`). Shape (n,).
    """
    for i in range(torque.shape[0]):
        proportional = arm.stiffness[i] * (set_point[POSITION, i] - position[i])
        torque[i] = proportional + arm.viscosity[i] * (set_point[VELOCITY, i] - velocity[i]) + torque[i]


@compiled
def filter_velocity(measured: Array, start: int, filtered: Array) -> None:
    """Advance the exponential filter of joint velocities, in place, in [rad/s].

    Args:
        measured: Velocities of all joints of the scene; the robot's own begin at `start`.
        filtered: Shape (n,).
    """
    for i in range(filtered.shape[0]):
        filtered[i] = JOINT_VELOCITY_FILTER * measured[start + i] + (1.0 - JOINT_VELOCITY_FILTER) * filtered[i]


@compiled
def set_motors(plant: Plant, arm: Arm, controller: Controller, k: int, r: int, noise: Array) -> bool:
    """Set robot r's motors for substep k; False when a torque is not finite.

    Args:
        noise: Torque added to each motor, in [N·m]; shape (20, R, n), or (0, R, n) for none.
    """
    n = controller.clipped.shape[1]
    start = r * plant.stride
    position = plant.qpos[start : start + n]
    set_point, torque = controller.set_points[r, k], controller.torque
    limit_set_point(arm, set_point, controller.clipped[r])
    link_rotations(arm, position, controller.rotations)
    velocity = controller.velocity[r]
    inverse_dynamics(arm, controller.rotations, velocity, set_point[ACCELERATION], controller.forces, torque)
    add_feedback(arm, set_point, position, velocity, torque)
    for i in range(n):
        if noise.shape[0] > 0:
            torque[i] += noise[k, r, i]
        if not math.isfinite(torque[i]):
            return False
        plant.ctrl[start + i] = min(max(torque[i], -arm.torque_limit[i]), arm.torque_limit[i])
    if arm.universal_joint:
        _set_striker_motors(plant, controller, r, start + n)
    return True


@compiled
def _set_striker_motors(plant: Plant, controller: Controller, r: int, start: int) -> None:
    """Set the motors of robot r's universal joint."""
    rod_axes(controller.rotations, controller.rod)
    desired = desired_angles(controller.rod)
    for i in range(2):
        # Both robots compare with robot 1's mallet: a slip of the official package, kept for parity.
        target = clip_angle(unwrap(desired[i], controller.striker_seen[i]))
        torque = striker_torque(target, plant.qpos[start + i], plant.qvel[start + i], controller.striker_average[r], i)
        plant.ctrl[start + i] = min(max(torque, -_STRIKER_TORQUE), _STRIKER_TORQUE)
