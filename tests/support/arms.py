"""Arms, and what one does with them in tests of the simulation."""

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from airhockey import envs
from airhockey.envs import scene
from airhockey.envs.kernel.arm import Arm, arm_from_model
from airhockey.envs.specs import IIWA, PLANAR, RobotSpec

Array = NDArray[np.float64]

ROBOTS = pytest.mark.parametrize("robot", [PLANAR, IIWA], ids=["planar", "iiwa"])
ALL = pytest.mark.parametrize("name", envs.ENVIRONMENTS)


@cache
def alone(robot: RobotSpec) -> tuple[Any, Any, Arm]:
    """MuJoCo's model and data of the arm alone, and the arrays that compiled code has of it."""
    model = scene.robot_model(robot)
    return model, mujoco.MjData(model), arm_from_model(robot, model)


def random_joints(robot: RobotSpec, seed: int, count: int = 20) -> Iterator[tuple[Array, Array, Array]]:
    """Positions within, velocities and accelerations at the scale of the limits. Each of shape (n,)."""
    random = np.random.default_rng(seed)
    limits = (robot.joint_position_limit, robot.joint_velocity_limit, robot.joint_acceleration_limit)
    for _ in range(count):
        position, velocity, acceleration = (random.uniform(*limit) for limit in limits)
        yield position, velocity, acceleration


def differences(function: Callable[[Array], Array], at: Array, step: float = 1e-6) -> Array:
    """Central differences of a function of a vector. Shape (m, n)."""
    moves = step * np.eye(at.size)
    return np.array([(function(at + move) - function(at - move)) / (2.0 * step) for move in moves]).T


def standing(env: envs.Environment, order: int | None = 3) -> Any:
    """The action, or the pair of them, that keeps the robots where they start."""
    start = np.array(env.simulation.robot.start)
    rows = np.stack([start, np.zeros_like(start), np.zeros_like(start)])
    rest = {None: np.tile(rows, (20, 1, 1)), 1: start, 2: start, 5: rows}
    action = rest.get(order, rows[:2])
    return action if env.n_players == 1 else (action, action.copy())


def swinging(env: envs.Environment, steps: int) -> Iterator[Any]:
    """Smooth motion around the start, for order 3."""
    start = np.array(env.simulation.robot.start)
    phase = np.arange(start.size)
    for k in range(1, steps + 1):
        swing = 0.1 * (np.sin(0.1 * k + phase) - np.sin(phase))
        action = np.stack([start + swing, 0.5 * np.cos(0.1 * k + phase)])
        yield action if env.n_players == 1 else (action, action)


def with_puck(env: envs.Environment, *puck: float) -> Array:
    """A base observation like the present one, but with the puck's position and velocity (6 numbers) as given."""
    rows = env.base_observation.reshape(env.n_agents, -1)
    rows[:, :6] = puck
    return rows.flatten()


def episode_bits(env: envs.Environment, steps: int = 60) -> bytes:
    """All that an environment tells in its next steps of swinging arms, as bytes."""
    told = []
    for action in swinging(env, steps):
        observation, _, absorbing, info = env.step(action)
        told += [observation.tobytes(), env.true_observation.tobytes(), env.constraint_values.tobytes()]
        told += [info["jerk"].tobytes(), bytes([absorbing])]
    return b"".join(told)


def striker_angles(x: Array, y: Array) -> tuple[float, float]:
    """The universal joint's angles for a rod with these axes: the challenge's formulas, the element-wise square included."""
    wanted = np.array([-y[1], y[0], 0.0])
    first = np.arctan2(np.cross(x, wanted) @ y, x @ wanted)
    cross = np.array([[0.0, -y[2], y[1]], [y[2], 0.0, -y[0]], [-y[1], y[0], 0.0]])
    turned = (np.eye(3) + cross * np.sin(first) + cross * cross * (1.0 - np.cos(first))) @ x
    wanted = np.array([turned[1], -turned[0], 0.0])
    return float(first), float(np.arctan2(np.cross(y, wanted) @ turned, y @ wanted))
