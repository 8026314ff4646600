"""Where the puck starts: random positions and velocities in world coordinates.

The draws come in the official package's order from NumPy's legacy generator, so that `np.random.seed(s)` gives the official
start of seed s.
"""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.editions import Range, Start

Array = NDArray[np.float64]
PuckState = tuple[Array, Array]
"""Position (x, y, yaw) and velocity (ẋ, ẏ, yaw rate), in [m, m, rad] and [m/s, m/s, rad/s]. Each of shape (3,)."""


def draw_start(name: str, starts: Mapping[str, Start], random: np.random.RandomState) -> PuckState:
    """Draw the puck's start.

    Args:
        name: A key of `starts`, or "prepare" for one of the two prepare areas, chosen by their sizes.
        starts: The ranges of an edition.
        random: Advanced as the official package would advance it.
    """
    if name == "prepare":
        return _draw_prepare(starts["prepare_side"], starts["prepare_bottom"], random)
    start = starts[name]
    position = np.zeros(3)
    position[:2] = _draw_point(start, random)
    velocity = np.zeros(3)
    if start.speed is not None and start.angle is not None:
        speed = random.uniform(*start.speed)
        angle = random.uniform(*start.angle)
        velocity[:2] = -math.cos(angle) * speed, math.sin(angle) * speed
    if start.yaw_rate is not None:
        velocity[2] = random.uniform(*start.yaw_rate)
    return position, velocity


def _draw_prepare(side: Start, bottom: Start, random: np.random.RandomState) -> PuckState:
    share = _area(side) / (_area(side) + _area(bottom))
    area = bottom if random.uniform(0, 1) >= share else side
    position = np.zeros(3)
    position[:2] = _draw_point(area, random)
    position[1] *= (1, -1)[random.randint(2)]
    return position, np.zeros(3)


def _draw_point(start: Start, random: np.random.RandomState) -> Array:
    ranges = np.array([start.x, start.y])
    return np.asarray(random.rand(2) * (ranges[:, 1] - ranges[:, 0]) + ranges[:, 0])


def _area(start: Start) -> float:
    return _length(start.x) * _length(start.y)


def _length(interval: Range) -> float:
    return interval[1] - interval[0]
