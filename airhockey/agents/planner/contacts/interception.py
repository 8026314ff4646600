"""Where and when to meet a moving puck: the best among all points of its predicted path that the mallet can reach in time.

The mallet meets the puck on its own line, going the same way more slowly, so that the puck lies still afterwards (`contact`).
The way there is judged as a cubic in time: by the speeds and accelerations that it asks of the rod tip.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.estimation.motion import advance
from airhockey.agents.planner.contacts.redirection import redirecting
from airhockey.agents.table import CONTACT, HALF_LENGTH

Array = NDArray[np.float64]

STEP = 0.01
"""Resolution of the puck's path, in [s]."""


class Reach(NamedTuple):
    """What the mallet can do, and where it may be; table frame.

    Attributes:
        speed: Largest speeds of the rod tip along x and y, in [m]/[s]. Shape (2,).
        acceleration: Largest accelerations along x and y, in [m]/[s²]. Shape (2,).
        lower, upper: Corners of where it may be, in [m]. Shape (2,).
    """

    speed: Array
    acceleration: Array
    lower: Array
    upper: Array


class CatchCost(NamedTuple):
    """What makes a good place to catch.

    Attributes:
        near_x, far_x: Where the puck shall be, in [m].
        best_x: Where it is best, in [m].
        place: Cost of the distance to `best_x`, per [m]².
        best_y, aside: |y| where it is best, in [m], and the cost of the distance to it, per [m]².
        deep_x, deep: A place behind this, in [m], costs that much more, per [m].
        speed: Cost of the puck's speed, per [m]/[s].
        effort: Cost of the squared effort beyond `easy`.
        easy: Effort, as a share of what the mallet can do, that costs nothing.
        bounce: Cost of each bounce before the contact: how much a rim returns is hard to foretell.
        settle, sudden: Cost of one less than this time before the contact, in [s].
        rest_x: Where a puck that is caught behind it shall roll to, in [m].
        standstill: Speed at which it counts as at rest there, in [m]/[s].
        push: Largest speed at which it is sent there, in [m]/[s].
        return_speed: With which a puck is sent back to the opponent's goal, in [m]/[s]; 0: it is caught.
        return_share: To which this share of the puck's own speed is added.
        mouth: A bounce off our end within this |y|, in [m], may become a goal: nothing after it counts.
        loyalty: What the present plan is worth.
        lead: The mallet has its final velocity from this time before the contact on, in [s].
        follow: And keeps it for this time after, in [s].
        grip: Whether the mallet has friction.
    """

    near_x: float
    far_x: float
    best_x: float
    place: float
    best_y: float
    aside: float
    deep_x: float
    deep: float
    speed: float
    effort: float
    easy: float
    bounce: float
    settle: float
    sudden: float
    rest_x: float
    standstill: float
    push: float
    return_speed: float
    return_share: float
    mouth: float
    loyalty: float
    lead: float
    follow: float
    grip: bool = True


class PuckPath(NamedTuple):
    """Where a puck will be at every `STEP`.

    Attributes:
        states: Shape (k, 5).
        bounces: So far. Shape (k,).
        since: Time since the last one, in [s]. Shape (k,).
    """

    states: Array
    bounces: Array
    since: Array


class Way(NamedTuple):
    """A cubic in time from one state of the mallet to another.

    Attributes:
        start, start_velocity: In [m] and [m]/[s]. Shapes (2,).
        end, end_velocity: The same at its end.
        time: It takes, in [s].
    """

    start: Array
    start_velocity: Array
    end: Array
    end_velocity: Array
    time: float


@compiled
def puck_path(state: Array, steps: int, mouth: float, constants: Array) -> PuckPath:
    """Where a puck will be at every `STEP`, until it may be in our goal.

    Args:
        state: Of the puck now. Shape (5,).
        steps: How far to look.
        mouth: See `CatchCost`.
        constants: `PuckMotion.constants`.
    """
    path = np.empty((steps + 1, 5))
    bounces, since = np.empty(steps + 1), np.empty(steps + 1)
    path[0], bounces[0], since[0] = state, 0.0, 10.0
    moving = state.copy()
    for i in range(1, steps + 1):
        end = moving[0] + 0.02 * moving[2] < -constants[0]
        new = advance(moving, STEP, constants)
        bounces[i] = bounces[i - 1] + new
        since[i] = 0.0 if new > 0 else since[i - 1] + STEP
        path[i] = moving
        if end and abs(moving[1]) < mouth:
            return PuckPath(path[:i], bounces[:i], since[:i])
    return PuckPath(path, bounces, since)


@compiled
def meeting(state: Array, wish: CatchCost) -> tuple[Array, Array]:
    """Where the mallet's centre is and how it moves when it catches (or returns) a puck. Shapes (2,), (2,)."""
    leaving = np.zeros(2)
    if wish.return_speed > 0.0:
        way = np.array([HALF_LENGTH - state[0], -state[1]])
        size = wish.return_speed + wish.return_share * np.hypot(state[2], state[3])
        leaving = size / np.hypot(way[0], way[1]) * way
    elif state[0] < wish.rest_x:  # a puck's speed falls by half of its way, in SI units
        leaving[0] = min(wish.standstill + 0.5 * (wish.rest_x - state[0]), wish.push)
    return redirecting(state, leaving, wish.grip)


@compiled
def effort(cubic: Way, reach: Reach) -> float:
    """What share of its means the mallet needs for a way; above 1: too much."""
    start, velocity, end, end_velocity, time = cubic
    total = 0.0
    for i in range(2):
        way = (end[i] - start[i]) / time
        first = (6.0 * way - 4.0 * velocity[i] - 2.0 * end_velocity[i]) / time
        last = (-6.0 * way + 2.0 * velocity[i] + 4.0 * end_velocity[i]) / time
        fastest = abs(end_velocity[i])
        if first * last < 0.0:
            fastest = max(fastest, abs(velocity[i] + 0.5 * first * time * first / (first - last)))
        need = max(max(abs(first), abs(last)) / reach.acceleration[i], fastest / reach.speed[i])
        total += need * need
    return float(np.sqrt(total))


@compiled
def touches_early(path: Array, cubic: Way, clearance: float) -> bool:
    """Whether a way brings the mallet nearer to the puck than a clearance, in [m], before it is there. Path (k, 5)."""
    start, velocity, end, end_velocity, time = cubic
    for k in range(1, int(time / STEP)):
        s = k * STEP / time
        distance = 0.0
        for i in range(2):
            way = end[i] - start[i]
            c2 = 3.0 * way - (2.0 * velocity[i] + end_velocity[i]) * time
            c3 = (velocity[i] + end_velocity[i]) * time - 2.0 * way
            position = start[i] + s * (velocity[i] * time + s * (c2 + s * c3))
            distance += (position - path[k, i]) ** 2
        if distance < clearance * clearance:
            return True
    return False


@compiled
def best_meeting(
    path: PuckPath, tip: Array, tip_velocity: Array, reach: Reach, wish: CatchCost, present: int
) -> tuple[int, float, float]:
    """The best point of a puck's path to catch it at.

    Args:
        path: Of the puck.
        tip, tip_velocity: Of the mallet now, in [m] and [m]/[s]. Shapes (2,), (2,).
        reach: What the mallet can do.
        wish: What is good.
        present: Index of the present plan, or −1.

    Returns:
        Index into the path (−1: none), cost, effort.
    """
    best, best_cost, best_effort = -1, np.inf, np.inf
    for i in range(2, len(path.states)):
        state = path.states[i]
        if state[0] < wish.near_x or state[0] > wish.far_x:
            continue
        place, velocity = meeting(state, wish)
        after = place + wish.follow * velocity
        if np.any(place < reach.lower) or np.any(place > reach.upper):
            continue
        if np.any(after < reach.lower) or np.any(after > reach.upper):
            continue
        time = max(i * STEP - wish.lead, 0.5 * STEP)
        begin = place - wish.lead * velocity
        way = Way(tip, tip_velocity, begin, velocity, time)
        need = effort(way, reach)
        speed = np.hypot(state[2], state[3])
        cost = wish.place * (state[0] - wish.best_x) ** 2 + wish.speed * speed
        cost += wish.aside * (abs(state[1]) - wish.best_y) ** 2
        cost += wish.deep * max(0.0, wish.deep_x - state[0])
        cost += wish.effort * max(0.0, need - wish.easy) ** 2
        cost += wish.bounce * path.bounces[i]
        if path.since[i] < wish.settle:
            cost += wish.sudden
        if abs(i - present) <= 1:
            cost -= wish.loyalty
        if cost < best_cost and not touches_early(path.states, way, 0.95 * CONTACT):
            best, best_cost, best_effort = i, cost, need
    return best, best_cost, best_effort
