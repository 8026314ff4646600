r"""Game: two players, points and faults, serve after serve.

Environment `tournament`, in every edition. World coordinates: origin in the table's centre, player 1 ("home") plays towards +x
and player 2 ("away") towards -x. The edition's file has the numbers.

| start of a serve | range | unit |
|---|---|---|
| puck x, y | ±(0.2 … 0.7) on the server's side, ±0.39105, at rest | m |
| joints | the robots' start, at rest | rad |

Who serves first is drawn; after a point it is the side that conceded, after a fault the other side, else the same one again.

| a serve ends | when | then |
|---|---|---|
| goal | \|x\| > 0.974 and \|y\| <= 0.125 | a point |
| fault | the puck stays on one side for more than 15 s, and \|x\| >= 0.15 | every third one is a point for the other |
| stuck | \|x\| < 0.15 and \|ẋ\| < 0.025 | nothing |
| off the table | \|x\| > 0.974 or \|y\| > 0.519, or ‖(ẋ, ẏ, yaw rate)‖ > 100 | nothing |

The game ends after 45,000 control steps of 0.02 s. Success: more points than the opponent, and not too many penalty points; the
evaluator judges that.

| reward | when | value |
|---|---|---|
| points | a player scores, by a goal or the other's third fault | +1, and -1 for the other |

Each player sees its own observation, in its robot frame, as if it played from the left; both stand one after the other:

| observation | quantity | range | unit |
|---|---|---|---|
| 0, 1, 2 | puck x, y, yaw in the robot frame | 0 … 3.02, ±1, ±π | m, m, rad |
| 3, 4, 5 | puck velocity | ±20, ±20, ±100 | m/s, m/s, rad/s |
| 6 … 5+n | joint positions | the joints' range | rad |
| 6+n … 5+2n | joint velocities, filtered | the joints' limits | rad/s |
| 6+2n … 8+2n | opponent's rod tip x, y, z | 1.5 … 4.5, ±1.5, ±1.5 | m |

The action is a pair, one per player:

| action, by order | rows | range | unit |
|---|---|---|---|
| 1, 2 | joint positions, shape (n,) | the joints' range | rad |
| 3, 4, -1 | positions, velocities, shape (2, n) | and the velocity limits | rad, rad/s |
| 5 | positions, velocities, accelerations, shape (3, n) | and the acceleration limits | …, rad/s² |
| None | 20 set-points of all three, shape (20, 3, n) | the same | rad, rad/s, rad/s² |

n is 7.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.specs import CONTROL_PERIOD, X_VELOCITY, X, Y
from airhockey.envs.tasks.task import Task
from airhockey.envs.tasks.verdicts import (
    FAULT_AWAY,
    FAULT_HOME,
    GOAL_AWAY,
    GOAL_HOME,
    GOING_ON,
    OFF_TABLE,
    STUCK,
    Rules,
    compiled,
    off_table,
)

Array = NDArray[np.float64]
HOME, AWAY = 0, 1
HOME_SERVES, AWAY_SERVES = 1, -1
"""As the official package counts."""


class Game(NamedTuple):
    """What the referee remembers of a game: small arrays, so that compiled code can advance it.

    Attributes:
        score, faults: Of player 1 and player 2. Shape (2,).
        side: Where the puck was: -1 player 1's side, 1 player 2's, 0 forgotten. Shape (1,).
        serve: Whose the next serve is, `HOME_SERVES` or `AWAY_SERVES`. Shape (1,).
        timer: How long the puck has been on its side, in [s]. Shape (1,).
    """

    score: NDArray[np.int64]
    faults: NDArray[np.int64]
    side: NDArray[np.int64]
    serve: NDArray[np.int64]
    timer: Array


def new_game() -> Game:
    """A game that has not begun; player 1 is to serve."""
    return Game(
        score=np.zeros(2, np.int64),
        faults=np.zeros(2, np.int64),
        side=np.zeros(1, np.int64),
        serve=np.full(1, HOME_SERVES),
        timer=np.zeros(1),
    )


@compiled
def judge_serve(rules: Rules, game: Game, puck: Array) -> int:
    """Advance the timer, score goals and faults, choose the next serve, and say what happened."""
    side = 1 if puck[X] > 0.0 else (-1 if puck[X] < 0.0 else 0)
    if side == game.side[0]:
        game.timer[0] += CONTROL_PERIOD
    else:
        game.side[0] = side
        game.timer[0] = 0.0
    if game.timer[0] > rules.fault_time and abs(puck[X]) >= rules.middle_zone:
        guilty = HOME if side < 0 else AWAY
        game.faults[guilty] += 1
        if game.faults[guilty] % rules.faults_per_point == 0:
            game.score[1 - guilty] += 1
        game.serve[0] = AWAY_SERVES if guilty == HOME else HOME_SERVES
        return FAULT_HOME if guilty == HOME else FAULT_AWAY
    if abs(puck[Y]) <= rules.goal_half_width and abs(puck[X]) > rules.half_length:
        scorer = HOME if puck[X] > 0.0 else AWAY
        game.score[scorer] += 1
        game.serve[0] = AWAY_SERVES if scorer == HOME else HOME_SERVES
        return GOAL_HOME if scorer == HOME else GOAL_AWAY
    if abs(puck[X]) < rules.middle_zone and abs(puck[X_VELOCITY]) < rules.stuck_speed:
        return STUCK
    return OFF_TABLE if off_table(rules, puck) else GOING_ON


@compiled
def judge(referee: Any, left: Array) -> int:
    """See `Task.judge`."""
    m = referee[0]
    return judge_serve(m, Game(m.score, m.faults, m.side, m.serve, m.timer), left)


def points_reward(before: list[int], after: list[int]) -> tuple[float, float]:
    """The rewards of player 1 and player 2 for a step, from the scores before and after it."""
    gain = float((after[HOME] - before[HOME]) - (after[AWAY] - before[AWAY]))
    return gain, -gain


TASK = Task(judge, players=2)
