"""What a control step leaves behind: base observation, the players' observations and the constraint values."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.kernel.arm import Arm
from airhockey.envs.kernel.chain import forward_kinematics
from airhockey.envs.kernel.compiling import compiled
from airhockey.envs.kernel.constraints import end_effector_constraints, joint_constraints, link_constraints
from airhockey.envs.kernel.controller import Controller
from airhockey.envs.kernel.kinematics import WorkSpace
from airhockey.envs.kernel.plant import Plant
from airhockey.envs.specs import JOINTS, X_VELOCITY, Y_VELOCITY, YAW, X, Y

Array = NDArray[np.float64]


class Readings(NamedTuple):
    """Views into one flat array: base observation (R, D), observations (R, D), constraints (R, K), jerk (R, n)."""

    base: Array
    observation: Array
    constraints: Array
    jerk: Array


def readings_of(flat: Array, robots: int, n: int, n_constraints: int) -> Readings:
    """Divide a flat array (see `readings_size`) into its parts."""
    width = JOINTS + 2 * n + (3 if robots == 2 else 0)
    a = robots * width
    c = 2 * a + robots * n_constraints
    return Readings(
        flat[:a].reshape((robots, width)),
        flat[a : 2 * a].reshape((robots, width)),
        flat[2 * a : c].reshape((robots, n_constraints)),
        flat[c : c + robots * n].reshape((robots, n)),
    )


compiled_readings_of = compiled(readings_of)
"""The same for compiled code. (Compiled code cannot return arrays: it does without numba's reference counts.)"""


def readings_size(robots: int, n: int, n_constraints: int) -> int:
    """Length of the flat array."""
    return robots * (2 * (JOINTS + 2 * n + (3 if robots == 2 else 0)) + n_constraints + n)


@compiled
def read(plant: Plant, arm: Arm, controller: Controller, work: WorkSpace, readings: Readings) -> None:
    """Fill `readings` (all but the jerk) from the present state, as it truly is."""
    robots, n = controller.clipped.shape
    for r in range(robots):
        base, row = readings.base[r], readings.observation[r]
        _read_world(plant, controller, r, base)
        _into_robot_frame(plant, r, n, base, row)
        _judge(arm, row, work, readings.constraints[r])


@compiled
def _read_world(plant: Plant, controller: Controller, r: int, base: Array) -> None:
    """Robot r's row of the base observation: puck, its joints, the other's rod tip."""
    n = controller.clipped.shape[1]
    first, start = plant.qpos.shape[0] - 3, r * plant.stride
    for i in range(3):
        base[X + i] = plant.qpos[first + i]
        base[X_VELOCITY + i] = plant.qvel[first + i]
    base[YAW] = (base[YAW] + math.pi) % (2.0 * math.pi) - math.pi
    for i in range(n):
        base[JOINTS + i] = plant.qpos[start + i]
        base[JOINTS + n + i] = controller.velocity[r, i]
    if plant.tips.shape[0] == 2:
        # The step's own kinematics placed the bodies: the rod tip is one substep old, as in the official package.
        for i in range(3):
            base[JOINTS + 2 * n + i] = plant.xpos[plant.tips[1 - r], i]


@compiled
def _into_robot_frame(plant: Plant, r: int, n: int, base: Array, row: Array) -> None:
    """The same seen from robot r's base."""
    side = plant.sides[r]
    for i in range(row.shape[0]):
        row[i] = base[i]
    row[X] = side * (base[X] - plant.base_x[r])
    row[Y] = side * base[Y]
    if side < 0.0:  # through the rotation matrix, so that yaw 0 is seen as +pi
        row[YAW] = math.atan2(0.0 - math.sin(base[YAW]), -math.cos(base[YAW]))
    row[X_VELOCITY], row[Y_VELOCITY] = side * base[X_VELOCITY], side * base[Y_VELOCITY]
    if plant.tips.shape[0] == 2:
        k = JOINTS + 2 * n
        row[k] = side * (base[k] - plant.base_x[r])
        row[k + 1] = side * base[k + 1]
        row[k + 2] = base[k + 2] - plant.base_z


@compiled
def _judge(arm: Arm, observation: Array, work: WorkSpace, values: Array) -> None:
    """Constraint values of one robot."""
    n = arm.mass.shape[0]
    position, velocity = observation[JOINTS : JOINTS + n], observation[JOINTS + n : JOINTS + 2 * n]
    joint_constraints(arm, position, velocity, values)
    forward_kinematics(arm, position, work.positions, work.axes)
    end_effector_constraints(work.positions[n], arm.desired_height, values[4 * n : 4 * n + 5])
    if arm.universal_joint:
        link_constraints(work.positions, values[4 * n + 5 :])
