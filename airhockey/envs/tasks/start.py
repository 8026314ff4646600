"""Where the puck starts: random positions and velocities in world coordinates.

The draws come in the official package's order from NumPy's legacy generator, so that `np.random.seed(s)` gives the official
start of seed s.
"""

import math

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.editions import Start

Array = NDArray[np.float64]
PuckState = tuple[Array, Array]
"""Position (x, y, yaw) and velocity (ẋ, ẏ, yaw rate), in [m, m, rad] and [m/s, m/s, rad/s]. Each of shape (3,)."""


def draw(areas: tuple[Start, ...], random: np.random.RandomState) -> PuckState:
    """Draw the puck's start from a single area: its place, then its motion if it has one.

    Args:
        areas: The ranges of an edition, here only one.
        random: Advanced as the official package would advance it.
    """
    (area,) = areas
    position, velocity = np.zeros(3), np.zeros(3)
    position[:2] = draw_place(area, random)
    while True:
        if area.speed is not None and area.angle is not None:
            speed = random.uniform(*area.speed)
            angle = random.uniform(*area.angle)
            velocity[:2] = -math.cos(angle) * speed, math.sin(angle) * speed
        if area.yaw_rate is not None:
            velocity[2] = random.uniform(*area.yaw_rate)
        if area.reach is None or abs(velocity[1] + position[1]) < area.reach:
            return position, velocity


def draw_place(area: Start, random: np.random.RandomState) -> Array:
    """A place in an area, in [m]. Shape (2,)."""
    ranges = np.array([area.x, area.y])
    return np.asarray(random.rand(2) * (ranges[:, 1] - ranges[:, 0]) + ranges[:, 0])
