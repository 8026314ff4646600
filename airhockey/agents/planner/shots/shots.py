"""Shots: when to strike, where to aim and off which wall; and how probably the puck ends in the goal. Compiled.

A shot is judged by one simulated flight of the puck: how far from the posts it passes the goal line, and how far from the
opponent's mallet it stays, both against the spread that the flight's length gives them.
"""

from math import copysign, exp, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.planner.shots.aiming import after_strike, mirrored, strike_normal
from airhockey.agents.planner.shots.flight import FLIGHT_STEP, arrives, fly, probability_positive, probability_within
from airhockey.agents.planner.shots.kinds import FULL, WAY
from airhockey.agents.planner.shots.shot_model import ShotModel

Array = NDArray[np.float64]

FORWARD = 0.3
"""Least x of a strike's direction: a unit vector's component."""
AROUND = 0.3
"""Time that it takes to go round the puck, in [s]."""
CORRECTIONS = 2
"""Of the aim of a bounced shot, after its flight: the mirror knows nothing of damping and spin."""
_DECAY = 3  # place in the constants of `PuckMotion`
FARTHEST_PACED = -0.25
"""x up to which a pace can be kept: further on the arm is so slow that a puck's speed is hard to foretell, in [m]."""
DAMPING = 0.5
"""For which the paces are given, in [1/s]."""
LONGER = 1.3
"""A way off a rim against the straight one."""
THERE = 0.02
"""Distance from which the mallet counts as being where a strike begins, in [m]."""
GRAIN = 0.005
"""Added to the spreads of all distances, in [m]."""


class Shot(NamedTuple):
    """A candidate.

    Attributes:
        value: Probability of a goal, less what waiting costs; 0 where the strike is impossible.
        wait: Time until contact, from now, in [s].
        aim: y on the goal line that is aimed at, in [m].
        wall: 0: no bounce; else how many, negative where the first is off the right wall.
        speed: Of the mallet, in [m]/[s].
        normal: Direction in which the mallet is commanded. Shape (2,).
        mallet: Centre of the mallet at contact, in [m]. Shape (2,).
    """

    value: float
    wait: float
    aim: float
    wall: float
    speed: float
    normal: Array
    mallet: Array


class Attempt(NamedTuple):
    """What is tried.

    Attributes:
        wait, aim, wall: As in `Shot`.
        margin: Time to spare that the way to the strike's beginning must leave, in [s].
    """

    wait: float
    aim: float
    wall: float
    margin: float


class Keeper(NamedTuple):
    """Who guards the goal.

    Attributes:
        places: As `opponent` of `fly`. Shape (k, 2).
        doubt: Standard deviation of where its mallet will be, in [m].
        heeds: As in `kinds.Kind`.
    """

    places: Array
    doubt: float
    heeds: bool


class Line(NamedTuple):
    """Where and how the mallet strikes: `mallet`, `normal` and `speed` of a `Shot`."""

    mallet: Array
    normal: Array
    speed: float


@compiled
def judge(seen: Array, attempt: Attempt, tip: Array, keeper: Keeper, pace: float, model: ShotModel) -> Shot:
    """Work out a shot and its value.

    Args:
        seen: The puck's predicted state at contact. Shape (5,).
        attempt: When to strike, and where to aim.
        tip: Where the mallet is now, in [m]. Shape (2,).
        keeper: Who guards the goal.
        pace: As in `kinds.Kind`.
        model: Constants.
    """
    wait, aim, wall, margin = attempt
    nothing = Shot(0.0, wait, aim, wall, 0.0, np.zeros(2), np.zeros(2))
    if seen[0] > (FARTHEST_PACED if pace < FULL else model.upper[0]):
        return nothing
    puck = seen.copy()
    puck[3] = model.drift_kept * seen[3] + model.spin_share * model.puck_radius * seen[4]
    rims = round(abs(wall))
    target = aim if rims == 0 else mirrored(aim, copysign(model.wall, wall), rims, model.slope)
    speed = float(np.interp(puck[0] - model.contact, model.speed_places, model.speeds))
    leaving = (
        pace
        + model.motion[_DECAY] * (model.goal_line - puck[0] - WAY)
        + LONGER * (model.motion[_DECAY] - DAMPING) * WAY
    )
    way_x, way_y = model.goal_line - puck[0], target - puck[1]
    speed *= 1.0 + model.diagonal * way_y * way_y / (way_x * way_x + way_y * way_y)
    speed = min(speed, model.fastest, (leaving - model.gain_slow + (model.gain - 1.0) * puck[2]) / model.gain)
    normal = _towards(puck, target, speed, model)
    room = room_speed(puck[:2] - model.contact * normal, normal, model)
    if room < speed:  # a slower mallet must strike more from the side that the puck moves to
        speed = room
        normal = _towards(puck, target, max(speed, model.least_speed), model)
    mallet = puck[:2] - model.contact * normal
    spare = wait - margin
    if (
        speed < model.least_speed
        or normal[0] < FORWARD
        or not possible(Line(mallet, normal, speed), spare, tip, puck, model)
    ):
        return nothing  # before the flight, which costs most
    goal, gap, length, passing, since = fly(
        _struck(puck, normal, speed, model), keeper.places, wait / FLIGHT_STEP, model
    )
    turns = 1.0 if rims % 2 == 0 else -1.0  # in an odd number of mirrors, left and right are swapped
    for _ in range(CORRECTIONS if rims > 0 else 0):
        if not arrives(goal):
            return nothing
        target += turns * (aim - goal) / model.slope**rims
        normal = _towards(puck, target, speed, model)
        mallet = puck[:2] - model.contact * normal
        if normal[0] < FORWARD or not possible(Line(mallet, normal, speed), spare, tip, puck, model):
            return nothing
        goal, gap, length, passing, since = fly(
            _struck(puck, normal, speed, model), keeper.places, wait / FLIGHT_STEP, model
        )
    value = 0.0
    if arrives(goal):
        spread = length * (model.direction_spread + rims * model.bounce_spread) + GRAIN
        late = model.timing_spread * passing
        # The way to the opponent is shorter than the whole flight, and it moves across the puck's way only in part.
        apart = sqrt((0.8 * spread) ** 2 + (0.4 * late) ** 2 + keeper.doubt**2) + GRAIN
        value = probability_within(goal, model.goal_half_width, spread)
        if keeper.heeds:
            value *= probability_positive(gap, apart)
        value *= exp(-model.patience * wait)
        if pace >= FULL and model.brisk > 0.0:
            near = aim * (wall if rims % 2 == 1 else -wall) > 0.0  # the post on the side where it bounces last
            if near and not keeper.heeds:
                value *= _suddenness(since, model.sudden)
            else:
                value *= _briskness(_struck(puck, normal, speed, model), model.brisk)
    commanded = turned(normal, model.turn)
    return Shot(value, wait, aim, wall, speed, commanded, puck[:2] - model.contact * commanded)


@compiled
def _briskness(struck: Array, brisk: float) -> float:
    """What a puck's speed is worth, as a share: its square, up to a speed that is enough, in [m]/[s]."""
    share = min(sqrt(struck[2] * struck[2] + struck[3] * struck[3]) / brisk, 1.0)
    return share * share


@compiled
def _suddenness(since: float, sudden: float) -> float:
    """What little time [s] after the last bounce is worth, as a share: its inverse to the fourth, down to one that is enough."""
    share = min(sudden / max(since, 1e-6), 1.0)
    return share * share * share * share


@compiled
def turned(normal: Array, share: float) -> Array:
    """A direction further from the x axis by a share of its sine. Shape (2,)."""
    y = min(max(normal[1] * (1.0 + share), -0.99), 0.99)
    return np.array([sqrt(1.0 - y * y), y])


@compiled
def gain_at(speed: float, model: ShotModel) -> float:
    """g of a contact at a speed of the mallet, in [m]/[s]: a slow one gives more, because the arm lags less."""
    return model.gain + model.gain_slow / max(speed, 0.1)


@compiled
def room_speed(mallet: Array, normal: Array, model: ShotModel) -> float:
    """The speed that the room behind the contact allows, in [m]/[s]: ½ v²/a + v·steady ≤ room."""
    room = 10.0
    for axis in range(2):
        if normal[axis] > 1e-6:
            room = min(room, (mallet[axis] - model.lower[axis]) / normal[axis])
        elif normal[axis] < -1e-6:
            room = min(room, (mallet[axis] - model.upper[axis]) / normal[axis])
    late = model.steady * model.acceleration
    return sqrt(late * late + 2.0 * model.acceleration * max(room - 0.001, 0.0)) - late


@compiled
def possible(strike: Line, spare: float, tip: Array, puck: Array, model: ShotModel) -> bool:
    """Whether the strike stays inside the workspace, and the mallet can be where it begins in time.

    Args:
        strike: Where and how.
        spare: Time until contact, in [s].
        tip: Where the mallet is now, in [m]. Shape (2,).
        puck: At contact. Shape (5,).
        model: Constants.
    """
    mallet, normal, speed = strike
    start = mallet - (0.5 * speed * speed / model.acceleration + speed * model.steady) * normal
    end = mallet + (speed * model.follow + 0.5 * speed * speed / model.braking) * normal
    for axis in range(2):
        for point in (start, mallet, end):
            if point[axis] < model.lower[axis] or point[axis] > model.upper[axis]:
                return False
    time = speed / model.acceleration + model.steady
    way = sqrt((start[0] - tip[0]) ** 2 + (start[1] - tip[1]) ** 2)
    if way > THERE:
        time += _way_time(way, model)
        if (puck[0] - tip[0]) * normal[0] + (puck[1] - tip[1]) * normal[1] < 0.5 * model.contact:
            time += AROUND  # the mallet is beside or before the puck
    return bool(spare >= time)


@compiled
def _way_time(way: float, model: ShotModel) -> float:
    """From rest to rest, in [s]."""
    reach = model.approach_speed**2 / model.approach_acceleration
    if way > reach:
        return 2.0 * model.approach_speed / model.approach_acceleration + (way - reach) / model.approach_speed
    return 2.0 * sqrt(way / model.approach_acceleration)


@compiled
def _towards(puck: Array, target: float, speed: float, model: ShotModel) -> Array:
    """The normal of the strike that sends the puck to y = target on the goal line. Shape (2,)."""
    x, y = model.goal_line - puck[0], target - puck[1]
    length = sqrt(x * x + y * y)
    return np.asarray(strike_normal(puck[2:4], np.array([x / length, y / length]), speed, gain_at(speed, model)))


@compiled
def _struck(puck: Array, normal: Array, speed: float, model: ShotModel) -> Array:
    flight = puck.copy()
    flight[2:4] = after_strike(puck[2:4], normal, speed, gain_at(speed, model))
    return flight
