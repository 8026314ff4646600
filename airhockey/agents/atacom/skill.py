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


def _see_defence(now: Situation) -> f.Features:
    return f.defend_features(now.puck.state, now.tip, now.tip_velocity)


def _defended(now: Situation) -> bool:
    return f.defended(now.puck.state, now.tip)


def _see_home(now: Situation) -> f.Features:
    return f.home_features(now.puck.state, now.tip, now.tip_velocity)


def _at_home(now: Situation) -> bool:
    return bool(np.hypot(*(HOME - now.tip)) < ARRIVED and np.hypot(*now.tip_velocity) < 0.1)


# Functions with names, since players are pickled.
DEFEND = LearnedTask("defend", f.DEFEND_MIRROR, _see_defence, _defended)
HOME_SKILL = LearnedTask("home", f.HOME_MIRROR, _see_home, _at_home)
SKILLS = {skill.name: skill for skill in (DEFEND, HOME_SKILL)}
