r"""Prepare: fetch a puck from the rim, where it cannot be hit, to the middle of the own half.

Environment `7dof-prepare`, and `prepare` in the edition of 2025; one robot. World coordinates: origin in the table's centre, x
towards the opponent's goal. The edition's file has the numbers.

| start | quantity | range | in 2025 | unit |
|---|---|---|---|---|
| along the side | puck x, \|y\| | -0.8 … -0.2, 0.39105 … 0.48535 | the same x, 0.41105 … 0.47535 | m |
| beside the own goal | puck x, \|y\| | -0.94 … -0.8, 0.125 … 0.48535 | the same x, 0.125 … 0.47535 | m |
| both | sign of y | either, with the same chance; at rest | the same | |
| | joints | the robot's start, at rest | the same | rad |

Which of the two is drawn in proportion to their areas.

| ends | when |
|---|---|
| off the table | \|x\| > 0.974 or \|y\| > 0.519, goals included, or ‖(ẋ, ẏ, yaw rate)‖ > 100 |
| task over | x > 0: the puck is lost to the other half; or \|y\| < 0.01: it is on the middle line |
| horizon | 500 control steps of 0.02 s |

Success: -0.8 < x <= -0.2, \|y\| < 0.39105 and ẋ < 0.1 at the last step.

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

n is 7.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.editions import Start
from airhockey.envs.specs import X, Y
from airhockey.envs.tasks.reward import TaskReward
from airhockey.envs.tasks.start import PuckState, draw_place
from airhockey.envs.tasks.task import Task
from airhockey.envs.tasks.verdicts import Rules, compiled, off_table, on_own_half, verdict_of

Array = NDArray[np.float64]


def draw_start(areas: tuple[Start, ...], random: np.random.RandomState) -> PuckState:
    """Choose the side or the bottom by their sizes, then a place in it, on either half of the table's width."""
    side, bottom = areas
    share = side.area / (side.area + bottom.area)
    chosen = bottom if random.uniform(0, 1) >= share else side
    position = np.zeros(3)
    position[:2] = draw_place(chosen, random)
    position[1] *= (1, -1)[random.randint(2)]
    return position, np.zeros(3)


@compiled
def over(rules: Rules, puck: Array) -> bool:
    """The puck is lost to the other half, or on the middle line."""
    return bool(puck[X] > 0.0 or abs(puck[Y]) < rules.middle_line)


@compiled
def succeeded(rules: Rules, puck: Array) -> bool:
    """The puck is where it can be hit, and does not run away."""
    return bool(on_own_half(rules, puck) and abs(puck[Y]) < rules.band_half_width)


@compiled
def judge(referee: Any, left: Array) -> int:
    """See `Task.judge`."""
    rules = referee[0]
    return verdict_of(off_table(rules, left), over(rules, left), succeeded(rules, left))


TASK = Task(judge, TaskReward, draw_start)
