"""The constants that the compiled search for shots needs, gathered from table, puck, robot and parameters."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.control.workspace import Workspace
from airhockey.agents.estimation.motion import puck_motion
from airhockey.agents.planner.shots.parameters import SmashParameters
from airhockey.agents.table import CONTACT, HALF_GOAL, HALF_LENGTH, to_table
from airhockey.envs.specs import PUCK

Array = NDArray[np.float64]

ALONG = 0.836
"""Share of its velocity along a wall that a puck without spin keeps in a bounce: right within 3 cm at the goal."""


class ShotModel(NamedTuple):
    """Table frame; units as in `SmashParameters`, whose attributes of the same names are meant.

    Attributes:
        motion: `PuckMotion.constants`. Shape (8,).
        wall: |y| where the puck's centre turns round, in [m].
        slope: What a bounce off a wall leaves of the slope of a puck's way: restitution over `ALONG`.
        puck_radius, contact: In [m]; distance of the centres at contact, in [m].
        goal_line: x of the opponent's goal, in [m]; ours is at its negative.
        mouth: |y| within which the puck must not be waited for near our own goal, in [m].
        lower, upper: Where the mallet may be in a strike, in [m]. Shapes (2,), (2,).
    """

    motion: Array
    wall: float
    slope: float
    puck_radius: float
    contact: float
    goal_line: float
    mouth: float
    lower: Array
    upper: Array
    gain: float
    gain_slow: float
    drift_kept: float
    spin_share: float
    turn: float
    speed_places: Array
    speeds: Array
    diagonal: float
    fastest: float
    brisk: float
    sudden: float
    least_speed: float
    acceleration: float
    braking: float
    steady: float
    follow: float
    direction_spread: float
    bounce_spread: float
    timing_spread: float
    goal_half_width: float
    patience: float
    approach_speed: float
    approach_acceleration: float
    approach_margin: float


def make_shot_model(parameters: SmashParameters, workspace: Workspace) -> ShotModel:
    """Gather them."""
    p, motion = parameters, puck_motion()
    lower, upper = to_table(workspace.lower) + p.edge, to_table(workspace.upper) - p.edge
    upper[0] = p.farthest
    taken = {name: value for name, value in vars(p).items() if name in ShotModel._fields}
    taken |= {"speed_places": np.array(p.speed_places), "speeds": np.array(p.speeds)}
    return ShotModel(
        motion=motion.constants,
        wall=float(motion.constants[1]),
        slope=motion.restitution / ALONG,
        puck_radius=PUCK.radius,
        contact=CONTACT,
        goal_line=HALF_LENGTH,
        mouth=HALF_GOAL + p.mouth_margin,
        lower=lower,
        upper=upper,
        **taken,
    )
