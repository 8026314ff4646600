"""The puck on its way: alone until it is struck, and afterwards to the opponent's goal. Compiled."""

from math import erf, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.estimation.motion import advance_by, decay_over, pieces_of, slide_by
from airhockey.agents.planner.shots.shot_model import ShotModel

Array = NDArray[np.float64]

FLIGHT_STEP = 0.02
"""Of a simulated flight, in [s]."""
_FLIGHT_STEPS = 250
_MISSED = 10.0
"""y of a puck that does not reach the goal line, in [m]."""
_STUCK = 0.05
"""Forward speed below which it never will, in [m]/[s]."""
_NEAR = 0.35
"""How far before the goal line the opponent is looked at, in [m]."""


@compiled
def move(state: Array, duration: float, motion: Array) -> None:
    """Move a state along, in place: in one piece where no rim is near, which is exact, else in small ones."""
    move_by(state, pace_of(duration, motion), motion)


class Pace(NamedTuple):
    """A duration [s], and what is known of it: `decay_over` it, the number of its pieces, `decay_over` a piece."""

    duration: float
    whole: tuple[float, float, float]
    pieces: int
    piece: tuple[float, float, float]


@compiled
def pace_of(duration: float, motion: Array) -> Pace:
    """What `move_by` needs to know of a duration, in [s]."""
    pieces = pieces_of(duration)
    return Pace(duration, decay_over(duration, motion), pieces, decay_over(duration / pieces, motion))


@compiled
def move_by(state: Array, pace: Pace, motion: Array) -> None:
    """`move` for a duration that occurs many times."""
    reach = pace.duration * max(abs(state[2]), abs(state[3]))
    if abs(state[0]) + reach < motion[0] and abs(state[1]) + reach < motion[1]:
        slide_by(state, pace.whole)
    else:
        advance_by(state, pace.pieces, pace.piece, motion)


@compiled
def coast(puck: Array, step: float, count: int, motion: Array) -> Array:
    """A puck's states at every `step` [s] from now, undisturbed. Shape (count + 1, 5)."""
    path, pace = np.empty((count + 1, 5)), pace_of(step, motion)
    path[0] = puck
    for k in range(count):
        path[k + 1] = path[k]
        move_by(path[k + 1], pace, motion)
    return path


@compiled
def state_at(path: Array, step: float, time: float) -> Array:
    """A state between those of a path. Shape (5,)."""
    place = min(max(time / step, 0.0), len(path) - 1.001)
    k = int(place)
    return np.asarray((1.0 - (place - k)) * path[k] + (place - k) * path[k + 1])


@compiled
def fly(puck: Array, opponent: Array, first: float, model: ShotModel) -> tuple[float, float, float, float, float]:
    """Let a puck fly to the opponent's goal line.

    Args:
        puck: Its state. Shape (5,).
        opponent: The opponent's mallet at every `FLIGHT_STEP` from now. Shape (k, 2).
        first: Index into it at which the flight begins.
        model: Constants.

    Returns:
        y on the goal line [m] (far off if it is never reached), the least gap to the opponent's mallet [m], the flight's
        length [m], the speed with which it passed the opponent [m]/[s], and the time from the last bounce, or else from the
        beginning, to the goal line [s].
    """
    state, gap, length, passing, since = puck.copy(), _MISSED, 0.0, 0.0, 0.0
    pace = pace_of(FLIGHT_STEP, model.motion)
    for k in range(_FLIGHT_STEPS):
        before_x, before_y, before_vy = state[0], state[1], state[3]
        move_by(state, pace, model.motion)
        since += FLIGHT_STEP
        if before_vy * state[3] < 0.0:
            since = max(FLIGHT_STEP - (model.wall - abs(before_y)) / abs(before_vy), 0.0)
        length += sqrt((state[0] - before_x) ** 2 + (state[1] - before_y) ** 2)
        if state[2] < _STUCK:
            break
        if state[0] > model.goal_line - _NEAR:
            at = opponent[min(int(first) + k + 1, len(opponent) - 1)]
            distance = sqrt((state[0] - at[0]) ** 2 + (state[1] - at[1]) ** 2) - model.contact
            if distance < gap:
                gap, passing = distance, sqrt(state[2] ** 2 + state[3] ** 2)
        if state[0] > model.goal_line:
            share = (model.goal_line - before_x) / (state[0] - before_x)
            late = (1.0 - share) * FLIGHT_STEP
            return before_y + share * (state[1] - before_y), gap, length, passing, since - late
    return _MISSED, gap, length, passing, since


@compiled
def arrives(y: float) -> bool:
    """Whether `fly` returned a place on the goal line."""
    return bool(abs(y) < 0.5 * _MISSED)


@compiled
def probability_within(y: float, half_width: float, spread: float) -> float:
    """That a normal variable about y lies within ± half_width."""
    scale = spread * sqrt(2.0)
    return 0.5 * (erf((half_width - y) / scale) + erf((half_width + y) / scale))


@compiled
def probability_positive(mean: float, spread: float) -> float:
    """That a normal variable is positive."""
    return 0.5 * (1.0 + erf(mean / (spread * sqrt(2.0))))
