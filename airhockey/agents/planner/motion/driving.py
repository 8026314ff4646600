"""Moving the mallet without hurry: towards a velocity, to a place, and round the puck."""

from math import hypot, sqrt

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.skill import Situation
from airhockey.agents.table import CONTACT

Array = NDArray[np.float64]

TURN = 0.35
"""How far along the circle round the puck to aim, in [rad]."""


def drive(situation: Situation, velocity: Array, acceleration: float) -> Array:
    """One step towards a velocity of the mallet.

    Args:
        situation: Now.
        velocity: Wanted, in [m]/[s]. Shape (2,).
        acceleration: With which it is reached, in [m]/[s²].

    Returns:
        Joint command. Shape (2, n).
    """
    (x, y), (present_x, present_y), (wanted_x, wanted_y) = (
        situation.tip.tolist(),
        situation.tip_velocity.tolist(),
        velocity.tolist(),
    )
    change_x, change_y = wanted_x - present_x, wanted_y - present_y
    share = min(1.0, acceleration * situation.dt / max(hypot(change_x, change_y), 1e-9))
    after_x, after_y = present_x + change_x * share, present_y + change_y * share
    half = 0.5 * situation.dt
    place = np.array([x + half * (present_x + after_x), y + half * (present_y + after_y)])
    return situation.move(place, np.array([after_x, after_y]))


def go_to(situation: Situation, place: Array, speed: float, acceleration: float, gain: float = 10.0) -> Array:
    """One step towards a place, arriving at rest. In [m], [m]/[s], [m]/[s²], [1/s]. Shape (2, n)."""
    way = place - situation.tip
    distance = max(hypot(*way.tolist()), 1e-9)
    braking = sqrt(1.2 * acceleration * distance)  # leaves a reserve: 2 a d would need all of it
    return drive(situation, way / distance * min(speed, braking, gain * distance), acceleration)


def is_clear(start: Array, end: Array, puck: Array, clearance: float) -> bool:
    """Whether the straight way between two places keeps a distance, in [m], from the puck's centre."""
    way = end - start
    length = float(way @ way)
    share = float(np.clip((puck - start) @ way / length, 0.0, 1.0)) if length > 1e-12 else 0.0
    return hypot(*(start + share * way - puck)) >= clearance


def round_the_puck(tip: Array, place: Array, puck: Array, lower: Array, upper: Array, gap: float) -> Array:
    """The next place to go to on a way that does not touch the puck.

    Straight to the place where that is clear; else along a circle about the puck, on the side where it stays on the table.

    Args:
        tip: Where the mallet is. Shape (2,).
        place: Where it is going. Shape (2,).
        puck: Shape (2,).
        lower, upper: Where the mallet may be. Shape (2,).
        gap: Between mallet and puck on the way; less where the mallet starts or ends nearer.

    Returns:
        Shape (2,).
    """
    near = min(CONTACT + gap, hypot(*(place - puck)), hypot(*(tip - puck))) - 0.001
    if is_clear(tip, place, puck, near):
        return place
    radius = CONTACT + 2.0 * gap
    here = float(np.arctan2(*(tip - puck)[::-1]))
    there = float(np.arctan2(*(place - puck)[::-1]))
    ways = []
    for sense in (1.0, -1.0):
        angle = (sense * (there - here)) % (2.0 * np.pi)
        samples = here + sense * np.linspace(0.0, angle, 12)
        circle = puck + radius * np.stack([np.cos(samples), np.sin(samples)], axis=1)
        outside = np.maximum(lower - circle, circle - upper).max(initial=0.0)
        ways.append((outside > 0.5 * gap, angle, sense))
    _, angle, sense = min(ways)
    ahead = here + sense * min(TURN, angle)
    return np.asarray(np.clip(puck + radius * np.array([np.cos(ahead), np.sin(ahead)]), lower, upper))
