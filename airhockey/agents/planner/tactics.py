"""Which skill plays: the table of what the planner does when."""

from typing import NamedTuple

import numpy as np

from airhockey.agents.skill import Situation
from airhockey.agents.table import CONTACT, HALF_LENGTH

SLOW = 0.15
"""Speed below which a puck can be prepared, in [m]/[s]."""
STILL = 0.06
"""The same while the puck is being caught, in [m]/[s]."""
APART = 0.02
"""Gap between mallet and puck beyond which a prepared puck may be shot at, in [m]."""
COMING = 0.4
"""Speed towards us above which a puck is defended against, in [m]/[s]."""
FAST = 0.6
"""Speed beyond which such a puck may be knocked back rather than caught, in [m]/[s]."""
OURS = 0.0
"""x up to which the puck is ours to play, in [m]."""


class Playing(NamedTuple):
    """The skill that acted last.

    Attributes:
        name: Of the skill.
        finished: Whether it has nothing left to do.
        committed: Whether its stroke is under way.
    """

    name: str
    finished: bool
    committed: bool


def choose(task: str, playing: Playing, stroke: str | None, answer: str, situation: Situation) -> str:
    """The name of the skill for this step.

    Args:
        task: "hit", "defend", "prepare", or anything else for a whole game.
        playing: What is played.
        stroke: Name of the skill that has a stroke worth trying, if any.
        answer: Name of the skill for a puck that comes fast.
        situation: Now.
    """
    if task in ("defend", "prepare"):
        return task
    now, finished, committed = playing
    if committed:
        return now
    puck, velocity = situation.puck.position, situation.puck.velocity
    coming = velocity[0] < -COMING
    if coming and task != "hit":  # in a game a fast puck is stopped first; in the hit task none is fast
        if now in ("defend", "repel") and not finished:
            return now
        return answer if situation.puck.speed > FAST else "defend"
    if stroke is not None and (
        finished or now != "prepare" or float(np.hypot(*(puck - situation.tip))) > CONTACT + APART
    ):
        return stroke
    if now == "prepare" and not finished and puck[0] < OURS:
        return "prepare"
    reach = puck[0] + velocity[0] / 0.5  # where damping alone would let it come to rest
    if coming or (puck[0] > OURS and velocity[0] < 0 and reach < OURS):
        return "defend"
    if -HALF_LENGTH < puck[0] < OURS:
        slow = STILL if now == "defend" and not finished else SLOW
        return "prepare" if situation.puck.speed < slow else "defend"
    return "ready"
