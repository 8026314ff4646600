"""Rewards on the way, in named terms, besides the task's own end.

| term | when | value |
|---|---|---|
| success | the episode ends, and the task is accomplished | 10 |
| failure | it ends, and is not | −1 |
| shaping | every step, with the reward `shaped` | γ Φ(after) − Φ(before); Φ = 0 at the end of an episode |
| progress | every step, with the reward `progress` | max(0, Φ(after) − the highest Φ of the episode so far) |

Success and failure are the thesis's B and P (4.9) in units of 100. Shaping changes no optimal policy (Ng, Harada and Russell
1999), and so is worth no more than a good first guess of the values. Progress is a real reward of at most some five points: it
pays for every step towards a success once, whatever happens later, which finds the first shot where chance hardly ever does.
Each task has its Φ:

| task | Φ |
|---|---|
| defend | −4 ‖y_crossing − y_tip‖ − 2 min(‖v_puck‖, 2 m/s), with y_crossing where the puck will cross x = −0.7 |
| hit | −2 ‖tip − puck‖ until the puck goes forward; then min(1, ẋ / 1.5 m/s) (1 + 4 exp(−(y_goal / 0.15 m)²)) |
| prepare | −4 max(0, ‖y‖ − 0.3 m) − ‖tip − puck‖ |

y_goal is where the puck will pass the opponent's goal line, bounces included.
"""

from math import exp, hypot

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.atacom.features import HORIZON, LINE, crossing
from airhockey.agents.estimation.motion import bounce, slide
from airhockey.agents.table import HALF_LENGTH
from airhockey.envs.vector.stepping import KINDS
from airhockey.learning.envs.compiling import allocating

Array = NDArray[np.float64]

REWARDS = ("shaped", "progress", "success")
"""What can be chosen: shaping, progress, or 1 for a success and nothing else; a number stands for each in compiled code."""
SHAPED, PROGRESS = 0, 1
SUCCESS, FAILURE = 10.0, -1.0
_HIT, _DEFEND = KINDS.index("hit"), KINDS.index("defend")
_STEP, _FARTHEST = 0.01, 2.0


@allocating
def potential(kind: int, puck: Array, tip: Array, constants: Array) -> float:
    """Φ of a moment.

    Args:
        kind: Index into `KINDS`.
        puck: x, y, ẋ, ẏ, yaw rate, in the table frame. Shape (5,).
        tip: Of the command, in the table frame, in [m]. Shape (2,).
        constants: `PuckMotion.constants`.
    """
    gap = hypot(puck[0] - tip[0], puck[1] - tip[1])
    if kind == _DEFEND:
        y = crossing(puck, LINE, HORIZON, constants)[1] if puck[0] > LINE else puck[1]
        return float(-4.0 * abs(y - tip[1]) - 2.0 * min(hypot(puck[2], puck[3]), 2.0))
    if kind == _HIT:
        if puck[2] < 0.1 or puck[0] < tip[0]:
            return -2.0 * gap
        y = goal_line(puck, constants)
        return float(min(1.0, puck[2] / 1.5) * (1.0 + 4.0 * exp(-((y / 0.15) ** 2))))
    return float(-4.0 * max(0.0, abs(puck[1]) - 0.3) - gap)


@allocating
def goal_line(puck: Array, constants: Array) -> float:
    """Where a puck that moves on its own first passes the opponent's goal line, y in [m]; far away if it does not."""
    there, time = puck.copy(), 0.0
    while time < _FARTHEST:
        slide(there, _STEP, constants)
        if there[0] > HALF_LENGTH - 0.04:
            return float(there[1])
        bounce(there, constants)
        time += _STEP
    return 10.0
