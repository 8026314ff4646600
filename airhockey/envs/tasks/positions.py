"""Where puck and mallet are: what rewards look at, read from a base observation."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.kernel.chain import forward_kinematics, point_jacobian
from airhockey.envs.specs import JOINTS, X_VELOCITY, Y_VELOCITY, X, Y

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PuckAndMallet:
    """Puck and mallet of player 1 in world coordinates.

    Attributes:
        puck: Position, in [m]. Shape (2,).
        puck_velocity: In [m]/[s]. Shape (2,).
        mallet: Position of the end-effector, in [m]. Shape (2,).
        mallet_velocity: In [m]/[s]. Shape (2,).
    """

    puck: Array
    puck_velocity: Array
    mallet: Array
    mallet_velocity: Array


def native(env: Any) -> Any:
    """The environment of this package behind the wrapper's base environment, or the environment itself."""
    return getattr(env, "_env", env)


def puck_and_mallet(env: Any, state: Array) -> PuckAndMallet:
    """Read a base observation.

    Args:
        env: The environment, or the wrapper's base environment.
        state: Base observation, in world coordinates; player 1's row comes first.
    """
    simulation = native(env).simulation
    n = simulation.robot.n_joints
    joint_position, joint_velocity = state[JOINTS : JOINTS + n], state[JOINTS + n : JOINTS + 2 * n]
    positions, axes, jacobian = np.empty((n + 1, 3)), np.empty((n + 2, 3)), np.empty((3, n))
    forward_kinematics(simulation.arm, joint_position, positions, axes)
    point_jacobian(positions, axes, n, jacobian)
    base_in_world = np.array(simulation.robot.base_positions[0][:2])  # robot 1 looks along the world's axes
    return PuckAndMallet(
        puck=state[X : Y + 1],
        puck_velocity=state[X_VELOCITY : Y_VELOCITY + 1],
        mallet=positions[n, :2] + base_in_world,
        mallet_velocity=jacobian[:2] @ joint_velocity,
    )
