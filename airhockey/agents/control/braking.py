"""How fast something may move now and still stop in time: joints before their limits, the rod tip before the edges."""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled

Array = NDArray[np.float64]


@compiled
def stopping_speed(distance: float, acceleration: float, dt: float) -> float:
    """The speed from which braking, beginning one step later, ends within a distance: v²/(2a) + v Δt = d.

    Args:
        distance: d, in [m] or [rad]. Beyond the limit (negative) the answer is the velocity that leads back in one
            step.
        acceleration: a, in [m]/[s²] or [rad]/[s²].
        dt: Δt, in [s].
    """
    if distance <= 0.0:
        return distance / dt
    return acceleration * (sqrt(dt * dt + 2.0 * distance / acceleration) - dt)


@compiled
def box_speeds(position: Array, lower: Array, upper: Array, acceleration: float, dt: float) -> Array:
    """The velocities from which something at a position within a box can stop before its sides. Shape (2, k)."""
    speeds = np.empty((2, position.size))
    for i in range(position.size):
        speeds[0, i] = -stopping_speed(position[i] - lower[i], acceleration, dt)
        speeds[1, i] = stopping_speed(upper[i] - position[i], acceleration, dt)
    return speeds


@compiled
def joint_speeds(
    q: Array, velocity: Array, position_limit: Array, velocity_limit: Array, acceleration: Array, dt: float
) -> Array:
    """Least and largest joint velocities at the end of the coming step.

    A joint at distance d from its limit, after moving on with its present velocity for half a step (equation 4.1 of the
    thesis), may end the step with the v that still stops in time: v²/(2a) + v Δt = d. The bounds never contradict the
    acceleration limit: a joint that is too fast is asked for the strongest braking.

    Args:
        q, velocity: Commanded joint positions [rad] and velocities [rad]/[s]. Shape (n,).
        position_limit, velocity_limit, acceleration, dt: See `bounds.JointBounds`.

    Returns:
        In [rad]/[s]. Shape (2, n).
    """
    speeds = np.empty((2, q.size))
    for i in range(q.size):
        coasted = q[i] + 0.5 * dt * velocity[i]
        change = acceleration[i] * dt
        high = min(velocity_limit[1, i], stopping_speed(position_limit[1, i] - coasted, acceleration[i], dt))
        low = max(velocity_limit[0, i], -stopping_speed(coasted - position_limit[0, i], acceleration[i], dt))
        speeds[1, i] = min(max(high, velocity[i] - change), velocity[i] + change)
        speeds[0, i] = max(min(low, velocity[i] + change), velocity[i] - change)
    return speeds
