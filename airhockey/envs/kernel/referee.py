"""When an episode is over, whether it succeeded, and the rules of a game: goals, faults, stuck pucks.

The tests read the puck's true state in world coordinates: `puck` is (x, y, yaw, ẋ, ẏ, yaw rate). A game's memory lives in a
`Game` of small arrays, so that compiled code can advance it.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.kernel.compiling import compiled
from airhockey.envs.specs import CONTROL_PERIOD

Array = NDArray[np.float64]

HIT, DEFEND, PREPARE, GAME = 0, 1, 2, 3
GOING_ON, OFF_TABLE, TASK_OVER, GOAL_HOME, GOAL_AWAY, FAULT_HOME, FAULT_AWAY, STUCK = 0, 1, 2, 3, 4, 5, 6, 7
"""Verdicts of a step. Home is player 1 (x < 0): `GOAL_HOME` is a point for player 1, `FAULT_HOME` a fault of player 1."""


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


class Game(NamedTuple):
    """What the referee remembers of a game.

    Attributes:
        score, faults: Of player 1 and player 2. Shape (2,).
        side: Where the puck was: -1 player 1's side, 1 player 2's, 0 forgotten; and the side of the next serve,
            1 for player 1's, as the official package counts. Shape (2,).
        timer: How long the puck has been on its side, in [s]. Shape (1,).
    """

    score: NDArray[np.int64]
    faults: NDArray[np.int64]
    side: NDArray[np.int64]
    timer: Array


@compiled
def off_table(rules: Rules, puck: Array) -> bool:
    """The puck has left the playing area, into a goal or over a rim, or moves faster than anything real."""
    speed = math.sqrt(puck[3] * puck[3] + puck[4] * puck[4] + puck[5] * puck[5])
    return bool(abs(puck[0]) > rules.half_length or abs(puck[1]) > rules.half_width or speed > rules.max_speed)


@compiled
def task_over(rules: Rules, kind: int, puck: Array) -> bool:
    """Nothing more can happen in this task."""
    if kind == HIT:
        return bool(puck[0] > 0.0 and puck[3] < 0.0)
    if kind == DEFEND:
        speed = math.sqrt(puck[3] * puck[3] + puck[4] * puck[4])
        return bool((puck[0] > 0.0 and puck[3] > 0.0) or speed < rules.standstill)
    return bool(puck[0] > 0.0 or abs(puck[1]) < rules.middle_line)


@compiled
def succeeded(rules: Rules, kind: int, puck: Array) -> bool:
    """Whether the episode would count as a success if it ended now."""
    if kind == HIT:
        return bool(puck[0] > rules.half_length and abs(puck[1]) < rules.goal_half_width)
    inside = bool(rules.near_x < puck[0] <= rules.far_x and puck[3] < rules.slow)
    if kind == DEFEND:
        return inside
    return bool(inside and abs(puck[1]) < rules.band_half_width)


@compiled
def judge_game(rules: Rules, game: Game, puck: Array) -> int:
    """Advance the timer, score goals and faults, choose the next serve, and say what happened."""
    side = 1 if puck[0] > 0.0 else (-1 if puck[0] < 0.0 else 0)
    if side == game.side[0]:
        game.timer[0] += CONTROL_PERIOD
    else:
        game.side[0] = side
        game.timer[0] = 0.0
    if game.timer[0] > rules.fault_time and abs(puck[0]) >= rules.middle_zone:
        guilty = 0 if side < 0 else 1
        game.faults[guilty] += 1
        if game.faults[guilty] % rules.faults_per_point == 0:
            game.score[1 - guilty] += 1
        game.side[1] = -1 if guilty == 0 else 1
        return FAULT_HOME if guilty == 0 else FAULT_AWAY
    if abs(puck[1]) <= rules.goal_half_width and abs(puck[0]) > rules.half_length:
        scorer = 0 if puck[0] > 0.0 else 1
        game.score[scorer] += 1
        game.side[1] = -1 if scorer == 0 else 1
        return GOAL_HOME if scorer == 0 else GOAL_AWAY
    if abs(puck[0]) < rules.middle_zone and abs(puck[3]) < rules.stuck_speed:
        return STUCK
    return OFF_TABLE if off_table(rules, puck) else GOING_ON
