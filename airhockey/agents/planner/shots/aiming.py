"""Aiming: along which line a mallet must strike a puck so that it leaves in a direction, and where a wall's mirror puts a goal.

The mallet is much heavier than the puck and moves along the normal n, the line from its centre to the puck's at contact; so a
strike changes the puck's velocity (almost) only along n. A mallet that moves at speed v leaves the puck with

    v_p' = v_p + g (v − v_p·n) n,      g = 1 + e

with g identified from the simulator (`SmashParameters.gain`).
"""

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled

Array = NDArray[np.float64]

_ITERATIONS = 8


@compiled
def after_strike(puck_velocity: Array, normal: Array, speed: float, gain: float) -> Array:
    """The puck's velocity after a strike, in [m]/[s].

    Args:
        puck_velocity: Before, in [m]/[s]. Shape (2,).
        normal: n, unit vector. Shape (2,).
        speed: Of the mallet along n, in [m]/[s].
        gain: g.

    Returns:
        Shape (2,).
    """
    along = puck_velocity[0] * normal[0] + puck_velocity[1] * normal[1]
    return np.asarray(puck_velocity + gain * max(speed - along, 0.0) * normal)


@compiled
def strike_normal(puck_velocity: Array, direction: Array, speed: float, gain: float) -> Array:
    """The normal n of the strike after which the puck moves in a direction.

    Across the direction u the puck must keep nothing: with n = cos θ u + sin θ w it is  v_p·w + g (v − v_p·n) sin θ = 0,
    solved for θ by fixed-point iteration (a contraction while the puck is slow compared to the mallet).

    Args:
        puck_velocity, speed, gain: As for `after_strike`.
        direction: u, unit vector. Shape (2,).

    Returns:
        n. Shape (2,).
    """
    across = np.array([-direction[1], direction[0]])
    drift = puck_velocity[0] * across[0] + puck_velocity[1] * across[1]
    forward = puck_velocity[0] * direction[0] + puck_velocity[1] * direction[1]
    sine = 0.0
    for _ in range(_ITERATIONS):
        cosine = np.sqrt(1.0 - sine * sine)
        impulse = gain * max(speed - forward * cosine - drift * sine, 0.1)
        sine = min(max(-drift / impulse, -0.9), 0.9)
    return np.asarray(np.sqrt(1.0 - sine * sine) * direction + sine * across)


@compiled
def mirrored(y: float, wall: float, rims: int, restitution: float) -> float:
    """Where to aim beyond the walls so that the puck comes off the last of them towards y.

    A bounce shrinks the lateral velocity by e; seen from before it, the way after it is 1/e times as long. Unfolded, the way
    across is the one to the first wall, then the table's width for every further bounce, and from the last wall to y.

    Args:
        y: Target, in [m].
        wall: The line on which the puck's centre turns round first; its sign tells which wall, in [m].
        rims: How many bounces, at least 1.
        restitution: e.

    Returns:
        y of the mirrored target, in [m].
    """
    side = 1.0 if wall > 0.0 else -1.0
    line, across, stretch = abs(wall), abs(wall), 1.0
    for _ in range(rims - 1):
        stretch /= restitution
        across += 2.0 * line * stretch
    last = side if rims % 2 == 1 else -side
    return side * (across + (line - last * y) * stretch / restitution)
