"""One control step, whole: 20 simulation steps under the joint controllers, then observation and constraints."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.kernel.arm import Arm
from airhockey.envs.kernel.compiling import compiled
from airhockey.envs.kernel.controller import Controller, filter_velocity, set_motors
from airhockey.envs.kernel.engine import mj_step
from airhockey.envs.kernel.interpolation import interpolate
from airhockey.envs.kernel.kinematics import WorkSpace
from airhockey.envs.kernel.observation import compiled_readings_of, read
from airhockey.envs.kernel.opponent import Opponent, figure_of_eight
from airhockey.envs.kernel.plant import Plant, plant_of, warned
from airhockey.envs.specs import SUBSTEPS

Array = NDArray[np.float64]

DONE, BAD_ACTION, BAD_TORQUE, ENGINE_WARNED = 0, -1, -2, -3
"""All is well; the action is not finite (nothing was simulated); it led to a set-point or a torque that is not; MuJoCo warned."""


class Players(NamedTuple):
    """How the robots are moved: whether robot 2 follows the figure of eight, constraints per robot, orders (R,)."""

    moving_opponent: bool
    n_constraints: int
    orders: NDArray[np.int64]


@compiled
def control_step(memory: Any, action: Array, noise: Array, left: Array) -> int:
    """Advance by one control step; `DONE`, or a negative error code.

    Args:
        memory: The record with `Addresses`, `Geometry`, `Arm`, `Controller`, `WorkSpace`, `Opponent` and `Players`. Shape (1,).
        action: The players' actions, padded to the same number of rows. Shape (R, rows, n).
        noise: Torque added to each motor in each substep, in [N·m]; shape (20, R, n), or (0, R, n) for none.
        left: Written: see `observation.readings_of`.
    """
    m = memory[0]
    plant, arm, controller = plant_of(m), _arm(m), _controller(m)
    work = WorkSpace(m.positions, m.axes, m.jacobian, m.step, m.error)
    robots, n = controller.clipped.shape
    readings = compiled_readings_of(left, robots, n, m.n_constraints)
    for r in range(robots):
        if r == 1 and m.moving_opponent:
            figure_of_eight(arm, Opponent(m.phase, m.commanded, m.target), work, action[1])
        elif not _all_finite(action[r]):
            return BAD_ACTION
    for r in range(robots):
        interpolate(m.orders[r], action[r], controller.command[r], controller.set_points[r], readings.jerk[r])
        if not _all_finite(controller.command[r]):  # or the next action, innocent, would be blamed
            return BAD_TORQUE
    if not _simulate(plant, arm, controller, noise):
        return BAD_TORQUE
    if warned(m):
        return ENGINE_WARNED
    read(plant, arm, controller, work, readings)
    return DONE


@compiled
def _all_finite(values: Array) -> bool:
    for row in range(values.shape[0]):
        for i in range(values.shape[1]):
            if not math.isfinite(values[row, i]):
                return False
    return True


@compiled
def _simulate(plant: Plant, arm: Arm, controller: Controller, noise: Array) -> bool:
    """The 20 substeps; False, with nothing more simulated, for a torque that is not finite."""
    robots, n = controller.clipped.shape
    for k in range(SUBSTEPS):
        for r in range(robots):
            if not set_motors(plant, arm, controller, k, r, noise):
                return False
        if arm.universal_joint:
            controller.striker_seen[0], controller.striker_seen[1] = plant.qpos[n], plant.qpos[n + 1]
        mj_step(plant.model, plant.data)
        for r in range(robots):
            filter_velocity(plant.qvel, r * plant.stride, controller.velocity[r])
    return True


@compiled
def _arm(m: Any) -> Arm:
    return Arm(
        m.offset,
        m.rotation,
        m.mass,
        m.center_of_mass,
        m.inertia,
        m.armature,
        m.tip,
        m.stiffness,
        m.viscosity,
        m.torque_limit,
        m.position_limit,
        m.velocity_limit,
        m.desired_height,
        m.universal_joint,
    )


@compiled
def _controller(m: Any) -> Controller:
    return Controller(
        m.command,
        m.clipped,
        m.velocity,
        m.striker_average,
        m.striker_seen,
        m.set_points,
        m.rotations,
        m.forces,
        m.torque,
        m.rod,
    )
