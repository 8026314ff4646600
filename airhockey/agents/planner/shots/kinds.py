"""Kinds of shots: what a player can vary on purpose, because it cannot know beforehand which of them a keeper fails against."""

from typing import NamedTuple

FULL = 9.0
"""A pace beyond every stroke: as fast as the arm allows, in [m]/[s]."""
WAY = 1.42
"""Way to the goal line for which the pace is given, in [m]: a longer one takes more."""


class Kind(NamedTuple):
    """What is asked of a shot.

    Attributes:
        name: For logs.
        rims: How many rims it takes before the goal; −1: none or one, as it comes.
        pace: Speed with which the puck leaves, in [m]/[s].
        lowest: Least |y| on the goal line that is aimed at, in [m].
        heeds: Whether the keeper's present place counts; otherwise only whether the puck would go in without it.
    """

    name: str
    rims: int
    pace: float
    lowest: float
    heeds: bool


OPEN = Kind("open", -1, FULL, 0.0, True)
"""Where the keeper leaves most room now: the only kind for a single episode."""
KINDS = (
    OPEN,
    Kind("corner", 0, FULL, 0.05, False),
    Kind("rim", 1, FULL, 0.0, False),
    Kind("middling rim", 1, 1.4, 0.0, False),
    Kind("slow rim", 1, 1.2, 0.04, False),
    Kind("slower rim", 1, 1.12, 0.04, False),
    Kind("slowest rim", 1, 1.04, 0.02, False),
    Kind("rolling corner", 0, 0.92, 0.06, False),
)
"""Those of a game. The slow ones come in by the rim with little left of their speed: who foresees no bounce goes the wrong
way first, and who does must wait."""
