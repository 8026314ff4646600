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
        post: Which post it is aimed at: 1 that on the side of the last rim, −1 the other, 0 either.
        heeds: Whether the keeper's present place counts; otherwise only whether the puck would go in without it.
    """

    name: str
    rims: int
    pace: float
    lowest: float
    post: int
    heeds: bool


OPEN = Kind("open", -1, FULL, 0.0, 0, True)
"""Where the keeper leaves most room now: the only kind for a single episode."""
ANY = OPEN._replace(heeds=False)
"""Away with the puck, whatever the keeper does: for when the 15 s on a side are running out."""
KINDS = (
    OPEN,
    Kind("corner", 0, FULL, 0.06, 0, False),
    Kind("near rim", 1, FULL, 0.07, 1, False),
    Kind("far rim", 1, FULL, 0.07, -1, False),
    Kind("middling near rim", 1, 2.0, 0.06, 1, False),
    Kind("middling far rim", 1, 2.0, 0.06, -1, False),
    Kind("double rim", 2, 2.8, 0.06, 1, False),
    Kind("triple rim", 3, 2.8, 0.0, 0, False),
    Kind("slow rim", 1, 1.18, 0.05, 1, False),
    Kind("slowest rim", 1, 1.1, 0.04, 1, False),
    Kind("rolling corner", 0, 0.9, 0.03, 0, False),
)
"""Those of a game. At full pace off a rim, a keeper has the least time after the bounce, and least of all at the post on that
side. Off two or three, as fast as the arm can so steeply across, the puck may pass behind a mallet before the goal. A keeper that
strikes at what comes misses slower ones. The slowest come in with little left of their speed: who foresees no bounce goes the
wrong way first, and who does must wait."""
