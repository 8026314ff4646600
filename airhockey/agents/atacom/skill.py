"""What a learned skill is, for the trainer and for the player alike: what it sees, when it is done, how often it acts."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from airhockey.agents.atacom import features as f
from airhockey.agents.atacom.controller import AtacomController
from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.skill import Situation
from airhockey.agents.table import HOME, to_table

REPEAT = 2
"""Control steps that an action lasts: 0.04 s."""
ARRIVED = 0.015
"""Distance from home that counts as home, in [m]."""


@dataclass(frozen=True)
class LearnedTask:
    """A task that is played by a network.

    Attributes:
        name: "defend" or "home".
        mirror: Signs of the observation's entries in a mirror along the table's middle line; their number is its size.
        observe: What the network sees of a situation.
        finished: Whether the skill has nothing left to do.
    """

    name: str
    mirror: f.Features
    observe: Callable[[Situation], f.Features]
    finished: Callable[[Situation], bool]


def situation(puck: PuckEstimate, controller: AtacomController) -> Situation:
    """The situation of a controller's command and a puck."""
    return Situation(puck, to_table(controller.tip), controller.tip_velocity)


DEFEND = LearnedTask(
    "defend",
    f.DEFEND_MIRROR,
    lambda s: f.defend_features(s.puck.state, s.tip, s.tip_velocity),
    lambda s: f.defended(s.puck.state, s.tip),
)
HOME_SKILL = LearnedTask(
    "home",
    f.HOME_MIRROR,
    lambda s: f.home_features(s.puck.state, s.tip, s.tip_velocity),
    lambda s: bool(np.hypot(*(HOME - s.tip)) < ARRIVED and np.hypot(*s.tip_velocity) < 0.1),
)
SKILLS = {skill.name: skill for skill in (DEFEND, HOME_SKILL)}
