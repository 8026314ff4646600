"""What a task's referee can say of a step, the thresholds that it goes by, and what all tasks have in common.

The referees read the puck's true state in world coordinates: x, y, yaw and their rates stand first in what a control step
leaves (`specs.X` … `specs.YAW_RATE`). A task's own tests, when it is over and when it has succeeded, are on its page.
"""

import math
import pathlib
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.envs import specs
from airhockey.envs.compiling import compiler
from airhockey.envs.specs import X_VELOCITY, Y_VELOCITY, YAW_RATE, X, Y

Array = NDArray[np.float64]

_FOLDER = pathlib.Path(__file__).parent
compiled = compiler(_FOLDER, [*_FOLDER.glob("*.py"), pathlib.Path(specs.__file__)], error_model="numpy", _nrt=False)
"""Compile a referee's function."""

GOING_ON, OFF_TABLE, TASK_OVER, GOAL_HOME, GOAL_AWAY, FAULT_HOME, FAULT_AWAY, STUCK = 0, 1, 2, 3, 4, 5, 6, 7
"""Verdicts of a step. Home is player 1 (x < 0): `GOAL_HOME` is a point for player 1, `FAULT_HOME` a fault of player 1."""
SUCCESS = 256
"""Added to the verdict when the episode would count as a success if it ended here."""


class Rules(NamedTuple):
    """The thresholds of an edition, in [m], [m/s], [s]. See the edition's file for their meaning."""

    half_length: float
    half_width: float
    goal_half_width: float
    max_speed: float
    near_x: float
    far_x: float
    band_half_width: float
    slow: float
    standstill: float
    middle_line: float
    fault_time: float
    faults_per_point: int
    middle_zone: float
    stuck_speed: float


@compiled
def off_table(rules: Rules, puck: Array) -> bool:
    """The puck has left the playing area, into a goal or over a rim, or moves faster than anything real."""
    speed = math.sqrt(
        puck[X_VELOCITY] * puck[X_VELOCITY] + puck[Y_VELOCITY] * puck[Y_VELOCITY] + puck[YAW_RATE] * puck[YAW_RATE]
    )
    return bool(abs(puck[X]) > rules.half_length or abs(puck[Y]) > rules.half_width or speed > rules.max_speed)


@compiled
def on_own_half(rules: Rules, puck: Array) -> bool:
    """The puck is in reach in front of the own goal and does not run away: where defend and prepare want it."""
    return bool(rules.near_x < puck[X] <= rules.far_x and puck[X_VELOCITY] < rules.slow)


@compiled
def verdict_of(off: bool, over: bool, success: bool) -> int:
    """The verdict of a step of a task, plus `SUCCESS`."""
    ended = OFF_TABLE if off else (TASK_OVER if over else GOING_ON)
    return ended + (SUCCESS if success else 0)
