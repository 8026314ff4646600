"""The table as a player sees it: origin at its centre, x towards the opponent, y to the left, in [m].

For player 1 this is the challenge's world frame; for player 2 it is that frame turned by 180°. A robot frame differs
from it by a shift along x (and in height, which players do not look at).
"""

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.specs import MALLET, PLANAR, PUCK, TABLE

Array = NDArray[np.float64]

HALF_LENGTH, HALF_WIDTH, HALF_GOAL = TABLE.length / 2, TABLE.width / 2, TABLE.goal_width / 2
CONTACT = PUCK.radius + MALLET.radius
"""Distance of the centres of puck and mallet when they touch, in [m]."""
OPPONENT_GOAL = np.array([HALF_LENGTH, 0.0])
OWN_GOAL = np.array([-HALF_LENGTH, 0.0])
HOME = np.array([-0.86, 0.0])
"""Where the mallet is at the start (challenge's section 1, thesis 4.2.4)."""

BASE_X = float(PLANAR.base_positions[0][0])
"""Where both robots stand, in [m]."""
_BASE = np.array([BASE_X, 0.0])


def to_table(position_in_robot: Array) -> Array:
    """A position of the robot frame in the table frame. Only x and y are looked at. Shape (2,)."""
    moved: Array = position_in_robot[:2] + _BASE
    return moved


def to_robot(position_in_table: Array) -> Array:
    """A position of the table frame in the robot frame. Shape (2,)."""
    moved: Array = position_in_table[:2] - _BASE
    return moved
