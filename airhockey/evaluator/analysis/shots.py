"""What became of the shots of a game: the one place that says what a hit, a shot, a goal and a save are.

A *hit* is a touch of the puck by a player's mallet (see `contacts`). A *shot* is a hit after which the puck crosses the
middle line away from the player, before anybody touches it again. It is

- a *goal* if it scores, off the opponent or not, before the player touches it again;
- *saved* if the opponent touched it while it was on target: left alone, sliding on with the table's friction and losing at
  the side rims what a bounce takes, it would have gone into the goal. One that would have come to rest before is no save;
- *off target* otherwise.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.estimation.motion import advance, puck_motion
from airhockey.envs.specs import CONTROL_PERIOD, PUCK, TABLE
from airhockey.evaluator.analysis.contacts import contacts, hits
from airhockey.evaluator.runs.game_records import AWAY, HOME, Event, Side

Array = NDArray[np.float64]
Outcome = Literal["goal", "saved", "off target"]
OUTCOMES: tuple[Outcome, ...] = ("goal", "saved", "off target")
_ROW = 23  # entries of a robot's half of a base observation ...
_OTHER = slice(20, 22)  # ... and where the other robot's rod tip stands in it
_DECAY = PUCK.slide_damping / PUCK.mass  # [1/s]


@dataclass(frozen=True)
class Hit:
    """A touch of the puck.

    Attributes:
        first, last: The rows at whose end the mallet had touched the puck.
        side: Whose mallet.
    """

    first: int
    last: int
    side: Side


@dataclass(frozen=True)
class Shot:
    """A shot, in world coordinates.

    Attributes:
        side: Whose.
        step: Of the hit, from 1.
        start: Where the puck was right after the hit, in [m].
        velocity: Its velocity there, in [m/s].
        outcome: See the module.
        touched: Step, from 1, in which somebody touched the puck next; None where nobody did before the next serve.
    """

    side: Side
    step: int
    start: tuple[float, float]
    velocity: tuple[float, float]
    outcome: Outcome
    touched: int | None = None

    @property
    def speed(self) -> float:
        """In [m/s]."""
        return float(np.hypot(*self.velocity))


def shots_of(rows: Array, events: Sequence[Event]) -> list[Shot]:
    """The shots of a game, in order.

    Args:
        rows: Base observations at the steps' ends. Shape (steps, 46).
        events: The referee's.
    """
    return shots_among(hits_of(rows, events), rows, events)


def hits_of(rows: Array, events: Sequence[Event]) -> list[Hit]:
    """The hits of a game, in the order of their ends."""
    found = []
    is_first = _serves(len(rows), events)
    first = np.flatnonzero(is_first)
    for side, row in ((HOME, slice(_ROW, 2 * _ROW)), (AWAY, slice(0, _ROW))):  # the other one's row holds the tip
        mallet = rows[:, row][:, _OTHER]
        before, mallet_before = np.roll(rows[:, :6], 1, axis=0), np.roll(mallet, 1, axis=0)
        before[first], mallet_before[first] = rows[first, :6], mallet[first]  # a serve is no hit
        touching = contacts(before, rows[:, :6], mallet_before, mallet)
        found += [Hit(int(begin), int(end), side) for begin, end in hits(touching, is_first)]
    return sorted(found, key=lambda hit: (hit.last, hit.side))


def shots_among(touches: Sequence[Hit], rows: Array, events: Sequence[Event]) -> list[Shot]:
    """The hits that are shots, see `shots_of`."""
    goals = {event.step: event.who for event in events if event.what == "goal"}
    ends = np.append(np.flatnonzero(_serves(len(rows), events)), len(rows))
    shots = []
    for number, hit in enumerate(touches):
        end_of_serve = int(ends[np.searchsorted(ends, hit.last, side="right")])
        follower = touches[number + 1] if number + 1 < len(touches) else None
        if follower is not None and follower.first >= end_of_serve:
            follower = None
        until = end_of_serve if follower is None else max(follower.first, hit.last + 1)
        towards = 1.0 if hit.side == HOME else -1.0
        if rows[hit.last, 0] * towards > 0.0 or not (rows[hit.last : until, 0] * towards > 0.0).any():
            continue
        outcome: Outcome = "off target"
        if goals.get(end_of_serve) == hit.side and _untouched(hit.side, touches[number + 1 :], end_of_serve):
            outcome = "goal"
        elif follower is not None and follower.side != hit.side and on_target(rows[until - 1], towards):
            outcome = "saved"
        x, y, _, x_speed, y_speed = map(float, rows[hit.last, :5])
        touched = None if follower is None else follower.first + 1
        shots.append(Shot(hit.side, hit.last + 1, (x, y), (x_speed, y_speed), outcome, touched))
    return shots


def on_target(puck: Array, towards: float) -> bool:
    """Whether the puck, left alone, slides into a goal.

    Args:
        puck: x, y, yaw and their rates in world coordinates, in [m], [rad] and [s]. Shape (≥ 6,).
        towards: 1 for the goal at the right end, -1 for the left one.
    """
    state = np.array([*puck[:2], *puck[3:6]], dtype=float)
    state[[0, 2]] *= towards  # mirrored, ...
    state[4] *= towards  # ... it turns the other way
    goal = TABLE.length / 2
    constants = puck_motion().constants
    while state[0] + state[2] / _DECAY > goal and state[2] > 0.0:  # does not come to rest before, nor turn back
        advance(state, CONTROL_PERIOD, constants)
        if state[0] > goal:
            return bool(abs(state[1]) <= TABLE.goal_width / 2)
    return False


def _serves(steps: int, events: Sequence[Event]) -> NDArray[np.bool_]:
    """The steps that are the first after a serve. Shape (steps,)."""
    is_first = np.zeros(steps, dtype=bool)
    is_first[[event.step for event in events if event.what == "serve" and event.step < steps]] = True
    return is_first


def _untouched(side: Side, later: Sequence[Hit], end: int) -> bool:
    """Whether a side does not touch the puck again before the end of the serve."""
    for hit in later:
        if hit.first >= end:
            break
        if hit.side == side:
            return False
    return True
