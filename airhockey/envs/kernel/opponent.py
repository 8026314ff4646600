"""The opponent of 7dof-hit: robot 2 moves its mallet along a figure of eight in front of its goal."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.kernel.arm import Arm
from airhockey.envs.kernel.compiling import compiled
from airhockey.envs.kernel.kinematics import WorkSpace, inverse_kinematics
from airhockey.envs.specs import CONTROL_PERIOD, POSITION, VELOCITY

Array = NDArray[np.float64]

ORDER = -1
"""Its interpolation order."""
_PHASE_RATE = 3.0  # [rad/s]
_CENTER_X, _HALF_LENGTH, _HALF_WIDTH = 0.65, 0.1, 0.16  # of the figure, in its own robot frame, in [m]


class Opponent(NamedTuple):
    """Where the opponent is on its way: phase in [rad], shape (1,); the joints it commanded last, shape (n,)."""

    phase: Array
    commanded: Array
    target: Array


def reset_opponent(opponent: Opponent, start: Array) -> None:
    """Begin the figure anew, from the start configuration `start`, in [rad]. Shape (n,)."""
    opponent.phase[0] = 0.5 * math.pi
    opponent.commanded[:] = start


@compiled
def figure_of_eight(arm: Arm, opponent: Opponent, work: WorkSpace, action: Array) -> None:
    """Write the next joint positions and velocities, by inverse kinematics from those commanded last.

    Args:
        action: Positions in [rad] and velocities in [rad/s]. Shape (2 or more, n).
    """
    opponent.phase[0] += _PHASE_RATE * CONTROL_PERIOD
    sine, cosine = math.sin(opponent.phase[0]), math.cos(opponent.phase[0])
    opponent.target[0] = _CENTER_X + _HALF_LENGTH * sine * cosine
    opponent.target[1] = _HALF_WIDTH * cosine
    opponent.target[2] = arm.desired_height
    n = opponent.commanded.shape[0]
    for i in range(n):
        action[VELOCITY, i] = opponent.commanded[i]
    inverse_kinematics(arm, opponent.target, opponent.commanded, work)
    for i in range(n):
        action[POSITION, i] = opponent.commanded[i]
        action[VELOCITY, i] = (opponent.commanded[i] - action[VELOCITY, i]) / CONTROL_PERIOD
