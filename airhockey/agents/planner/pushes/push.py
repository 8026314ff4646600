"""A push: a short motion of the mallet that touches a puck at rest once, and what becomes of the puck.

The mallet runs up from rest to the place of contact, goes straight on for a moment, and retreats to rest: two cubics and a line.
A push is an array of 11 numbers: see the indices below.
"""

import math

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.estimation.motion import bounce, slide
from airhockey.agents.planner.contacts.puck_physics import TIME_STEP, Mallet, clearance, step
from airhockey.agents.table import CONTACT

Array = NDArray[np.float64]

START, PLACE, VELOCITY, END = 0, 2, 4, 6
"""Where a push begins, where the mallet touches the puck, its velocity there, where it ends: two numbers each, table frame."""
RUN_UP, FOLLOW, RETREAT = 8, 9, 10
"""Durations of the three pieces, in [s]."""
LENGTH = 11
EARLY = 0.08
"""Coming near the puck so long before the contact is out of turn, in [s]."""
FREE_STEP = 0.004
"""Of the puck where nothing can touch it meanwhile, in [s]."""


@compiled
def cubic_at(
    start: float, speed: float, end: float, end_speed: float, duration: float, time: float
) -> tuple[float, float]:
    """Position and velocity at a time of the cubic between two states, along one axis."""
    way = (end - start) / duration
    c2 = (3.0 * way - 2.0 * speed - end_speed) / duration
    c3 = (speed + end_speed - 2.0 * way) / (duration * duration)
    return start + time * (speed + time * (c2 + time * c3)), speed + time * (2.0 * c2 + 3.0 * time * c3)


@compiled
def mallet_at(push: Array, axis: int, time: float) -> tuple[float, float]:
    """Position and velocity of the mallet along one axis at a time after the contact, in [s], [m] and [m]/[s]."""
    place, velocity = push[PLACE + axis], push[VELOCITY + axis]
    if time < 0.0:
        time = max(time + push[RUN_UP], 0.0)
        return cubic_at(push[START + axis], 0.0, place, velocity, push[RUN_UP], time)
    if time < push[FOLLOW]:
        return place + time * velocity, velocity
    begin = place + push[FOLLOW] * velocity
    time = min(time - push[FOLLOW], push[RETREAT])
    return cubic_at(begin, velocity, push[END + axis], 0.0, push[RETREAT], time)


@compiled
def possible(push: Array, lower: Array, upper: Array, speed: Array, acceleration: Array) -> bool:
    """Whether the mallet stays in a rectangle and within its means along x and y. Shapes (2,) each."""
    steps = int(np.ceil((push[RUN_UP] + push[FOLLOW] + push[RETREAT]) / 0.02))
    for i in range(2):
        last = 0.0
        for k in range(steps + 1):
            position, velocity = mallet_at(push, i, 0.02 * k - push[RUN_UP])
            if position < lower[i] or position > upper[i]:
                return False
            if abs(velocity) > speed[i] or abs(velocity - last) > 0.02 * acceleration[i]:
                return False
            last = velocity
    return True


@compiled
def puck_after(
    puck: Array, push: Array, constants: Array, friction: float, rim: float, middle: float
) -> tuple[Array, bool]:
    """The puck's state at the end of a push, or when it comes to the long axis of the table.

    Args:
        puck: State before, at rest. Shape (5,).
        push: Shape (11,).
        constants: `PuckMotion.constants`.
        friction: μ between mallet and puck.
        rim: Damping ratio of the rims, as a multiple of the nominal one.
        middle: |y| that counts as the long axis, in [m].

    Returns:
        Shape (5,), and whether the mallet touched it out of turn: in the run-up or the late retreat.
    """
    state = puck.copy()
    time, end = -push[RUN_UP], push[FOLLOW] + push[RETREAT]
    while time < 0.0:  # the puck lies still until the mallet is there
        x, _ = mallet_at(push, 0, time)
        y, _ = mallet_at(push, 1, time)
        if math.hypot(x - puck[0], y - puck[1]) < CONTACT + 0.005:
            break
        time += 0.005
    if time < -EARLY:
        return state, True
    while time < end:
        x, vx = mallet_at(push, 0, time)
        y, vy = mallet_at(push, 1, time)
        fastest = math.hypot(state[2], state[3]) + math.hypot(vx, vy) + 0.05
        if clearance(state, x, y) > FREE_STEP * fastest:
            slide(state, FREE_STEP, constants)
            time += FREE_STEP
        else:
            time += TIME_STEP
            x, vx = mallet_at(push, 0, time)
            y, vy = mallet_at(push, 1, time)
            if math.hypot(x - state[0], y - state[1]) < 0.5 * CONTACT:  # squeezed out of all proportion
                return state, True
            if step(state, Mallet(x, y, vx, vy), friction, rim) and time > push[FOLLOW] + 0.5 * push[RETREAT]:
                return state, True
        if abs(state[1]) < middle or state[0] > 0.0:
            break
    return state, False


@compiled
def coast(puck: Array, constants: Array, middle: float, horizon: float) -> tuple[int, Array]:
    """Let a puck roll on, from bounce to bounce: what ends it, and its last state.

    With damping c a free puck's way is straight and even in τ = (1 − exp(−c t))/c:  p(τ) = p + v τ,  v(τ) = v (1 − c τ).

    Args:
        puck: Shape (5,).
        constants: `PuckMotion.constants`.
        middle: |y| that counts as the long axis of the table, in [m].
        horizon: In [s].

    Returns:
        0: nothing did; 1: it came to the long axis; 2: to the other half or into our goal. And the state. Shape (5,).
    """
    state = puck.copy()
    half_x, half_y, goal, decay, spin_decay = constants[0], constants[1], constants[2], constants[3], constants[4]
    left = horizon
    for _ in range(40):
        if state[0] > 0.0 or state[0] < -half_x - 0.01:
            return 2, state
        if abs(state[1]) < middle:
            return 1, state
        x, y, vx, vy = state[0], state[1], state[2], state[3]
        inwards = -math.copysign(1.0, y) * vy
        events = (
            (abs(y) - middle) / inwards if inwards > 0.0 else math.inf,
            -x / vx if vx > 0.0 else math.inf,
            max(half_y - abs(y), 0.0) / -inwards if inwards < 0.0 else math.inf,
            max(x + half_x, 0.0) / -vx if vx < 0.0 else math.inf,
        )
        first = min(events)
        end = (1.0 - math.exp(-decay * left)) / decay
        way = min(first, end)
        keep = 1.0 - decay * way
        time = -math.log(max(keep, 1e-9)) / decay
        left -= time
        state[0] += vx * way
        state[1] += vy * way
        state[2] *= keep
        state[3] *= keep
        state[4] *= math.exp(-spin_decay * time)
        if first >= end:
            return 0, state
        if events[0] == first:
            return 1, state
        if events[1] == first or (events[3] == first and abs(state[1]) < goal):
            return 2, state
        # On the rim by the arithmetic; over it by a hair, so that it counts as passed.
        if events[2] == first:
            state[1] = math.copysign(half_y + 1e-9, state[1])
        else:
            state[0] = -half_x - 1e-9
        bounce(state, constants)
    return 0, state
