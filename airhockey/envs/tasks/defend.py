r"""Defend: stop a puck that comes from the opponent's half, and keep it on the own one.

Environments `3dof-defend` and `7dof-defend`, and `defend` in the edition of 2025; one robot each. World coordinates: origin in
the table's centre, x towards the opponent's goal. The edition's file has the numbers.

| start | range | in 2025 | unit |
|---|---|---|---|
| puck x, y | 0.29 … 0.65, ±0.4 | 0.4 … 0.75, ±0.4 | m |
| speed; direction, from -x | 1 … 3; ±0.5 | 1 … 5; ±0.75 | m/s; rad |
| yaw rate | ±10 | ±10 | rad/s |
| joints | the robot's start, at rest | the same | rad |

| ends | when |
|---|---|
| off the table | \|x\| > 0.974 or \|y\| > 0.519, goals included, or ‖(ẋ, ẏ, yaw rate)‖ > 100 |
| task over | x > 0 and ẋ > 0: the puck is back where it came from; or ‖(ẋ, ẏ)‖ < 0.1: it lies still |
| horizon | 500 control steps of 0.02 s |

Success: -0.8 < x <= -0.2 and ẋ < 0.1 at the last step.

| reward | when | value |
|---|---|---|
| success | the episode ends, and the task is accomplished | B |
| failure | the episode ends, and it is not | -P |
| constraints | every step | -(4.2) |

| observation | quantity | range | unit |
|---|---|---|---|
| 0, 1, 2 | puck x, y, yaw in the robot frame | 0 … 3.02, ±1, ±π | m, m, rad |
| 3, 4, 5 | puck velocity | ±20, ±20, ±100 | m/s, m/s, rad/s |
| 6 … 5+n | joint positions | the joints' range | rad |
| 6+n … 5+2n | joint velocities, filtered | the joints' limits | rad/s |

| action, by order | rows | range | unit |
|---|---|---|---|
| 1, 2 | joint positions, shape (n,) | the joints' range | rad |
| 3, 4, -1 | positions, velocities, shape (2, n) | and the velocity limits | rad, rad/s |
| 5 | positions, velocities, accelerations, shape (3, n) | and the acceleration limits | …, rad/s² |
| None | 20 set-points of all three, shape (20, 3, n) | the same | rad, rad/s, rad/s² |

n is 3 or 7.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.specs import X_VELOCITY, Y_VELOCITY, X
from airhockey.envs.tasks.reward import TaskReward
from airhockey.envs.tasks.task import Task
from airhockey.envs.tasks.verdicts import Rules, compiled, off_table, on_own_half, verdict_of

Array = NDArray[np.float64]


@compiled
def over(rules: Rules, puck: Array) -> bool:
    """The puck is back where it came from, or lies still."""
    speed = math.sqrt(puck[X_VELOCITY] * puck[X_VELOCITY] + puck[Y_VELOCITY] * puck[Y_VELOCITY])
    return bool((puck[X] > 0.0 and puck[X_VELOCITY] > 0.0) or speed < rules.standstill)


@compiled
def succeeded(rules: Rules, puck: Array) -> bool:
    """The puck is on the own half, clear of the goal, and does not run away."""
    return on_own_half(rules, puck)


@compiled
def judge(referee: Any, left: Array) -> int:
    """See `Task.judge`."""
    rules = referee[0]
    return verdict_of(off_table(rules, left), over(rules, left), succeeded(rules, left))


TASK = Task(judge, TaskReward)
