"""What the learned skills see: a few numbers of order one, in the table frame, and how a mirrored table changes them."""

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.estimation.motion import bounce, puck_motion, slide
from airhockey.agents.table import CONTACT, HOME

Array = NDArray[np.float64]
Features = NDArray[np.float32]

LINE = -0.7
"""Where a puck's crossing is predicted, in the table frame, in [m]."""
HORIZON = 1.5
"""How far ahead it is looked for, in [s]."""
SLOW = 0.3
"""A puck slower than this, in [m]/[s], is defended: the rest is waiting."""

_CONSTANTS = puck_motion().constants

DEFEND_MIRROR: Features = np.array([1, -1, 1, -1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, -1], dtype=np.float32)
"""Signs of a defend observation's entries seen in a mirror along the table's middle line."""
HOME_MIRROR: Features = np.array([1, -1, 1, -1, 1, -1, 1, 1, -1, 1, 1, -1], dtype=np.float32)
ACTION_MIRROR: Features = np.array([1, -1], dtype=np.float32)


@compiled
def crossing(state: Array, line: float, horizon: float, constants: Array) -> Array:
    """When and how a puck first passes a line towards the own goal.

    Args:
        state: x, y [m], ẋ, ẏ [m]/[s], yaw rate [rad]/[s]. Shape (5,).
        line: x of the line, in [m].
        horizon: In [s].
        constants: `PuckMotion.constants`.

    Returns:
        Time [s], y [m], ẋ, ẏ [m]/[s]; where it does not within the horizon, how it is then. Shape (4,).
    """
    puck, step, time = state.copy(), 0.005, 0.0
    while puck[0] > line and time < horizon:
        slide(puck, step, constants)
        bounce(puck, constants)
        time += step
    return np.array([time, puck[1], puck[2], puck[3]])


def defend_features(puck: Array, tip: Array, tip_velocity: Array) -> Features:
    """The observation of the skill *defend*.

    | index | quantity | unit |
    |---|---|---|
    | 0, 1 | puck x + 0.5, y | m, 0.5 m |
    | 2, 3, 4 | puck velocity, yaw rate | 2 m/s, 2 m/s, 20 rad/s |
    | 5, 6 | tip x + 0.8, y | 0.2 m, 0.5 m |
    | 7, 8 | tip velocity | m/s |
    | 9, 10 | from tip to puck | 0.5 m, 0.5 m |
    | 11, 12 | crossing of `LINE`: time, y | s, 0.5 m |
    | 13, 14 | velocity there | 2 m/s |
    | 15 | from tip to crossing, y | 0.2 m |

    Args:
        puck: x, y, ẋ, ẏ, yaw rate, in the table frame. Shape (5,).
        tip, tip_velocity: Of the command, in the table frame. Shapes (2,), (2,).

    Returns:
        Within [−5, 5]. Shape (16,).
    """
    time, y, x_speed, y_speed = crossing(puck, LINE, HORIZON, _CONSTANTS)
    raw = (
        puck[0] + 0.5, 2.0 * puck[1], 0.5 * puck[2], 0.5 * puck[3], 0.05 * puck[4],
        5.0 * (tip[0] + 0.8), 2.0 * tip[1], tip_velocity[0], tip_velocity[1],
        2.0 * (puck[0] - tip[0]), 2.0 * (puck[1] - tip[1]),
        time, 2.0 * y, 0.5 * x_speed, 0.5 * y_speed, 5.0 * (y - tip[1]),
    )  # fmt: skip
    return np.clip(np.array(raw, dtype=np.float32), -5.0, 5.0)


def defended(puck: Array, tip: Array) -> bool:
    """Whether there is nothing left to defend: the puck is slow, goes away, or is behind the tip."""
    return bool(np.hypot(puck[2], puck[3]) < SLOW or puck[2] > 0.0 or puck[0] < tip[0] - 0.02)


def home_features(puck: Array, tip: Array, tip_velocity: Array) -> Features:
    """The observation of the skill *home*: the way there, and the puck that may be in it.

    | index | quantity | unit |
    |---|---|---|
    | 0, 1 | from tip to home | 0.5 m |
    | 2, 3 | the same within 0.1 m | 0.1 m |
    | 4, 5 | tip velocity | m/s |
    | 6 | distance to home | m |
    | 7, 8 | from tip to puck within 0.3 m | 0.15 m |
    | 9 | gap between puck and mallet within 0.2 m | 0.1 m |
    | 10, 11 | puck velocity | m/s |

    Args:
        puck: x, y, ẋ, ẏ, yaw rate, in the table frame. Shape (5,).
        tip, tip_velocity: Of the command, in the table frame, in [m] and [m]/[s]. Shapes (2,), (2,).

    Returns:
        Within [−5, 5]. Shape (12,).
    """
    way, to_puck = HOME - tip, puck[:2] - tip
    near, beside = np.clip(10.0 * way, -1.0, 1.0), np.clip(to_puck / 0.15, -2.0, 2.0)
    gap = min(10.0 * (float(np.hypot(*to_puck)) - CONTACT), 2.0)
    raw = np.array([*(2.0 * way), *near, *tip_velocity, np.hypot(*way), *beside, gap, *puck[2:4]], dtype=np.float32)
    return np.clip(raw, -5.0, 5.0)
