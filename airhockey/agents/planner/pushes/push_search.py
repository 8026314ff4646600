"""Which push brings a puck from a rim to where it can be played: random search, each candidate tried out in `puck_physics`.

Half of the candidates are drawn, the other half vary the best one so far. A candidate counts by several tries with the puck, the
mallet and the rims not quite as they are believed to be.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.planner.contacts.puck_physics import put_on_table
from airhockey.agents.planner.contacts.redirection import RESTITUTION
from airhockey.agents.planner.pushes.push import (
    END,
    FOLLOW,
    LENGTH,
    PLACE,
    RETREAT,
    RUN_UP,
    START,
    VELOCITY,
    coast,
    possible,
    puck_after,
)
from airhockey.agents.table import CONTACT

Array = NDArray[np.float64]

DOUBTS = np.array(
    [
        [0.0, 0.0, 0.0, 0.0],
        [1.0, 1.0, 1.0, 1.0],
        [-1.0, -1.0, -1.0, -1.0],
        [1.0, -1.0, -1.0, 1.0],
        [-1.0, 1.0, 1.0, -1.0],
        [1.0, 1.0, -1.0, -1.0],
        [-1.0, -1.0, 1.0, 1.0],
        [1.0, -1.0, 1.0, -1.0],
        [-1.0, 1.0, -1.0, 1.0],
    ]
)
"""Tries of a candidate: the puck's x and y, the mallet's speed and the rims not quite as believed; a two-level design."""
_RESTITUTION = 5  # place in the constants of `PuckMotion`


_UNKNOWN = np.zeros(2)  # until it is known who plays


class Goal(NamedTuple):
    """What a push shall achieve (from `prepare.yaml`), and with what means (the robot's).

    Attributes:
        near_x, far_x, wide_y: The good places: x between the first two, |y| up to the third, in [m].
        slow: Largest ẋ with which the puck may come to the long axis, in [m]/[s].
        middle: How close to it the puck ends the task, in [m].
        margin: Distance to the border of the good places beyond which more is no better, in [m].
        doubt: How wrong the puck's place may be, in [m].
        haste: How wrong the mallet's speed may be, as a share.
        rim, rebound: How wrong the rims' damping ratio and restitution may be, as shares.
        horizon: For how long the puck may roll, in [s].
        lower, upper: Where the mallet may be, in [m]. Shape (2,).
        speed, acceleration: Largest along x and y, in [m]/[s] and [m]/[s²]. Shape (2,).
        friction: μ between mallet and puck.
    """

    near_x: float
    far_x: float
    wide_y: float
    slow: float
    middle: float
    margin: float
    doubt: float
    haste: float
    rim: float
    rebound: float
    horizon: float
    lower: Array = _UNKNOWN
    upper: Array = _UNKNOWN
    speed: Array = _UNKNOWN
    acceleration: Array = _UNKNOWN
    friction: float = 1.0


@compiled
def worth(ended: int, puck: Array, goal: Goal) -> float:
    """How good it is that the puck is there: 1 to 2 a success, 0 to 1 a place to go on from, −1 the end.

    Args:
        ended: What `coast` says.
        puck: Its last state. Shape (5,).
        goal: What was wanted.
    """
    if ended == 2:
        return -1.0
    inside = min(puck[0] - goal.near_x, goal.far_x - puck[0], 1.5 * (goal.slow - puck[2]))
    if ended == 1:
        return float(1.2 + 0.8 * min(inside / goal.margin, 1.0)) if inside > 0.0 else -1.0
    inside = min(inside, goal.wide_y - abs(puck[1]))
    if inside > 0.0:
        return float(1.0 + 0.8 * min(inside / goal.margin, 1.0))
    far = max(goal.near_x - puck[0], puck[0] - goal.far_x, 0.0)
    wide = max(abs(puck[1]) - goal.wide_y, 0.0)
    return float(max(0.0, 0.8 - 1.5 * far - 2.0 * wide))  # the nearer the better


@compiled
def value(puck: Array, push: Array, goal: Goal, constants: Array, least: float) -> float:
    """Half the least and half the mean of a push's worth over the doubts; gives up early below `least`."""
    return _valued(puck, push, goal, constants, least)[0]


@compiled
def _valued(puck: Array, push: Array, goal: Goal, constants: Array, least: float) -> tuple[float, int]:
    """The value, and how many doubts it took to tell."""
    total, lowest = 0.0, 2.0
    bounces = constants.copy()
    for k in range(len(DOUBTS)):
        state, played = puck.copy(), push.copy()
        for i in range(2):
            state[i] += goal.doubt * DOUBTS[k, i]
            played[VELOCITY + i] *= 1.0 + goal.haste * DOUBTS[k, 2]
        bounces[_RESTITUTION] = constants[_RESTITUTION] * (1.0 - goal.rebound * DOUBTS[k, 3])
        put_on_table(state, 0.0002)
        after, awry = puck_after(state, played, constants, goal.friction, 1.0 + goal.rim * DOUBTS[k, 3], goal.middle)
        if awry:
            return -1.0, k + 1
        ended, rest = coast(after, bounces, goal.middle, goal.horizon)
        w = worth(ended, rest, goal)
        if np.hypot(rest[0] - puck[0], rest[1] - puck[1]) < 0.02:
            w = -0.5
        total, lowest = total + w, min(lowest, w)
        if 0.5 * lowest + 1.0 < least:
            return -1.0, k + 1
    return 0.5 * lowest + 0.5 * total / len(DOUBTS), len(DOUBTS)


@compiled
def draw(puck: Array, goal: Goal, rng: np.random.Generator) -> Array:
    """A push at random: half of them meant to send the puck to a good place directly."""
    push = np.empty(LENGTH)
    side = 1.0 if puck[1] > 0.0 else -1.0
    for _ in range(30):
        angle = rng.uniform(0.0, 2.0 * np.pi)
        outward = np.array([np.cos(angle), np.sin(angle)])
        place = puck[:2] + CONTACT * outward
        if np.all(place > goal.lower) and np.all(place < goal.upper):
            break
    tangent = np.array([-outward[1], outward[0]])
    speed, across = rng.uniform(0.05, 0.8), rng.uniform(-0.8, 0.8)
    if rng.uniform(0.0, 1.0) < 0.5:
        rest = np.array([rng.uniform(goal.near_x, goal.far_x), side * rng.uniform(-0.2, goal.wide_y)])
        wanted = 0.5 * (rest - puck[:2])  # a rolling puck stops after twice its speed, in SI units
        normal = -(wanted[0] * outward[0] + wanted[1] * outward[1])
        along = wanted[0] * tangent[0] + wanted[1] * tangent[1]
        if normal > 0.02 and abs(along) < normal:
            speed = normal / (1.0 + RESTITUTION)
            across = 3.0 * along
    push[PLACE : PLACE + 2] = place
    push[VELOCITY : VELOCITY + 2] = across * tangent - speed * outward
    push[RUN_UP] = rng.uniform(0.25, 0.5)
    push[FOLLOW] = rng.uniform(0.0, 0.04)
    push[RETREAT] = rng.uniform(0.25, 0.4)
    turn = rng.uniform(-1.6, 1.6)
    away = np.cos(turn) * outward + np.sin(turn) * tangent
    push[END : END + 2] = place + rng.uniform(0.04, 0.12) * away
    finish(push, goal)
    return push


@compiled
def vary(best: Array, puck: Array, goal: Goal, rng: np.random.Generator) -> Array:
    """A push like another."""
    push = best.copy()
    outward = push[PLACE : PLACE + 2] - puck[:2]
    angle = np.arctan2(outward[1], outward[0]) + 0.1 * rng.normal()
    push[PLACE : PLACE + 2] = puck[:2] + CONTACT * np.array([np.cos(angle), np.sin(angle)])
    size = np.hypot(push[VELOCITY], push[VELOCITY + 1])
    for i in range(2):
        push[VELOCITY + i] += 0.12 * size * rng.normal()
        push[END + i] += 0.01 * rng.normal()
    push[FOLLOW] = min(max(push[FOLLOW] + 0.005 * rng.normal(), 0.0), 0.06)
    finish(push, goal)
    return push


@compiled
def finish(push: Array, goal: Goal) -> None:
    """Begin where an even acceleration would, or as near as the table allows; end on the table."""
    for i in range(2):
        start = push[PLACE + i] - 0.5 * push[RUN_UP] * push[VELOCITY + i]
        push[START + i] = min(max(start, goal.lower[i]), goal.upper[i])
        push[END + i] = min(max(push[END + i], goal.lower[i]), goal.upper[i])


class Found(NamedTuple):
    """A push and its value (below −1: there is none yet), and how many candidates were tried for it."""

    push: Array
    value: float
    tried: int = 0


@compiled
def search(
    puck: Array, found: Found, goal: Goal, constants: Array, rng: np.random.Generator, tries: int, effort: int
) -> Found:
    """Improve on a push, by so many tries or until so many doubts have been played out; gives the best one."""
    best, best_value, tried = found
    spent, until = 0, tried + tries
    while tried < until and spent < effort:
        tried += 1
        local = best_value > -0.4 and rng.uniform(0.0, 1.0) < 0.5
        push = vary(best, puck, goal, rng) if local else draw(puck, goal, rng)
        if not possible(push, goal.lower, goal.upper, goal.speed, goal.acceleration):
            continue
        worth_of_it, doubts = _valued(puck, push, goal, constants, best_value)
        spent += doubts
        if worth_of_it > best_value:
            best, best_value = push, worth_of_it
    return Found(best, best_value, tried)
