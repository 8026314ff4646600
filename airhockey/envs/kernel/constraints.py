"""The values of the challenge's constraints: a constraint is violated where its value is positive."""

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.kernel.arm import Arm
from airhockey.envs.kernel.compiling import compiled
from airhockey.envs.specs import IIWA, MALLET, SOFT_LIMIT, TABLE

Array = NDArray[np.float64]

MIN_END_EFFECTOR_X = -IIWA.base_positions[0][0] - (TABLE.length / 2 - MALLET.radius)
"""Lowest x of the end-effector in the robot frame, in [m]: the mallet touches the rim. Both robots stand at the same distance."""
MAX_END_EFFECTOR_Y = TABLE.width / 2 - MALLET.radius
"""Largest distance of the end-effector from the middle line, in [m]."""
HEIGHT_TOLERANCE = 0.02
"""How far the end-effector may be above or below its desired height, in [m]."""
MIN_LINK_HEIGHT = 0.25
"""Lowest height of elbow (link 4) and wrist (link 7) in the robot frame, in [m]."""
ELBOW, WRIST = 3, 6


@compiled
def joint_constraints(arm: Arm, position: Array, velocity: Array, values: Array) -> None:
    """Write joint position then joint velocity constraints: upper limits, lower limits, each. Shape (4n,)."""
    n = position.shape[0]
    for i in range(n):
        values[i] = position[i] - SOFT_LIMIT * arm.position_limit[1, i]
        values[n + i] = SOFT_LIMIT * arm.position_limit[0, i] - position[i]
        values[2 * n + i] = velocity[i] - SOFT_LIMIT * arm.velocity_limit[1, i]
        values[3 * n + i] = SOFT_LIMIT * arm.velocity_limit[0, i] - velocity[i]


@compiled
def end_effector_constraints(tip: Array, desired_height: float, values: Array) -> None:
    """Write the five constraints of the end-effector's position (robot frame, in [m]): x, y twice, z twice. Shape (5,)."""
    values[0] = MIN_END_EFFECTOR_X - tip[0]
    values[1] = -MAX_END_EFFECTOR_Y - tip[1]
    values[2] = tip[1] - MAX_END_EFFECTOR_Y
    values[3] = (desired_height - HEIGHT_TOLERANCE) - tip[2]
    values[4] = tip[2] - (desired_height + HEIGHT_TOLERANCE)


@compiled
def link_constraints(positions: Array, values: Array) -> None:
    """Write the constraints of wrist and elbow height, from the links' positions in the robot frame. Shape (2,)."""
    values[0] = MIN_LINK_HEIGHT - positions[WRIST, 2]
    values[1] = MIN_LINK_HEIGHT - positions[ELBOW, 2]
