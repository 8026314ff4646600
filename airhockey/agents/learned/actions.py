"""What a learner's action means, and how it becomes a command that keeps every constraint.

| kind | action, each entry in [−1, 1] | shape |
|---|---|---|
| joints | velocity of every joint's set-point, in units of half its limit | (n,) |
| tip | velocity of the rod tip in the table plane, in units of 1.2 m/s | (2,) |
| mallet | where the mallet shall go: x from the near rim to 0.15 m before the middle line, y from rim to rim | (2,) |

All go through ATACOM (`airhockey.agents.atacom`): the command is its state, so that no action, noise or network can make it
leave the constraints.
"""

from math import hypot, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.atacom.chain import chain_of, task_coordinates
from airhockey.agents.atacom.controller import Model, integrate
from airhockey.agents.atacom.following import gains_of
from airhockey.agents.atacom.limits import limits_of
from airhockey.agents.atacom.parameters import atacom_parameters
from airhockey.agents.compiling import compiled, in_place
from airhockey.agents.small_matrices import product
from airhockey.agents.table import BASE_X
from airhockey.envs.compiled import MAX_END_EFFECTOR_Y, MIN_END_EFFECTOR_X
from airhockey.envs.specs import CONTROL_PERIOD, RobotSpec

Array = NDArray[np.float64]

ACTIONS = ("joints", "tip", "mallet")
"""The kinds; a number stands for each in compiled code."""
_MALLET = ACTIONS.index("mallet")
_FRONT = -0.15
"""Largest x that the mallet can be sent to, in the table frame, in [m]."""
_BRAKING = 4.0
"""Deceleration before the target, in [m]/[s²]."""
_FOLLOWING = 8.0
"""Speed per distance near the target, in [1/s]."""


class Controls(NamedTuple):
    """The controllers of N arms.

    Attributes:
        kind: Index into `ACTIONS`.
        model: ATACOM's.
        substeps: Its steps in a control step.
        center, half: Of the rectangle that the mallet can be sent to, in the robot frame, in [m]. Shapes (2,), (2,).
        wanted: What ATACOM is asked for. Shape (N, m).
        q, velocity: The commands, in [rad] and [rad]/[s]. Shapes (N, n), (N, n).
        tip, tip_velocity: Where they put the rod tip, in the table frame, in [m] and [m]/[s]. Shapes (N, 2), (N, 2).
    """

    kind: int
    model: Model
    substeps: int
    center: Array
    half: Array
    wanted: Array
    q: Array
    velocity: Array
    tip: Array
    tip_velocity: Array


def new_controls(kind: str, spec: RobotSpec, n_envs: int) -> Controls:
    """Controllers for n environments."""
    p, n = atacom_parameters(spec), spec.n_joints
    low = np.array([MIN_END_EFFECTOR_X + p.edge_margin, p.edge_margin - MAX_END_EFFECTOR_Y])
    high = np.array([_FRONT - BASE_X, MAX_END_EFFECTOR_Y - p.edge_margin])
    return Controls(
        ACTIONS.index(kind),
        Model(chain_of(spec), limits_of(spec, p), gains_of(spec, p)),
        p.substeps,
        (low + high) / 2.0,
        (high - low) / 2.0,
        *(np.zeros((n_envs, width)) for width in (n if kind == "joints" else 2, n, n, 2, 2)),
    )


def warm_up(controls: Controls) -> None:
    """Compile what allocates, before what calls it: or numba takes the caller's options for it."""
    q, velocity = controls.q[0], controls.velocity[0]
    _move(controls.model, controls.substeps, controls.wanted[0], q, velocity)
    _look(controls.model, q, velocity, controls.tip[0], controls.tip_velocity[0])


@in_place
def take_position(controls: Controls, i: int, q: Array) -> None:
    """Begin an episode: the command of arm i is where it stands, at rest. Shape (n,)."""
    for j in range(q.size):
        controls.q[i, j], controls.velocity[i, j] = q[j], 0.0
    _look(controls.model, controls.q[i], controls.velocity[i], controls.tip[i], controls.tip_velocity[i])


@in_place
def command(controls: Controls, i: int, action: Array, order: Array) -> None:
    """Move the command of arm i on by a control step.

    Args:
        controls: Brought up to date.
        i: Which arm.
        action: Shape (n,) or (2,).
        order: Written: position and velocity, an action of interpolation order 3. Shape (2 or more, n).
    """
    wanted, q, velocity = controls.wanted[i], controls.q[i], controls.velocity[i]
    for j in range(wanted.size):
        wanted[j] = min(max(action[j], -1.0), 1.0)
    if controls.kind == _MALLET:
        _towards(controls, i, wanted)
    _move(controls.model, controls.substeps, wanted, q, velocity)
    for j in range(q.size):
        order[0, j], order[1, j] = q[j], velocity[j]
    _look(controls.model, q, velocity, controls.tip[i], controls.tip_velocity[i])


@in_place
def _towards(controls: Controls, i: int, wanted: Array) -> None:
    """Replace a place by the tip's velocity on the way to it, which ends there at rest, in units of its largest. Shape (2,)."""
    x = controls.center[0] + controls.half[0] * wanted[0] - (controls.tip[i, 0] - BASE_X)
    y = controls.center[1] + controls.half[1] * wanted[1] - controls.tip[i, 1]
    distance, largest = hypot(x, y), controls.model.gains.speed
    speed = min(largest, sqrt(2.0 * _BRAKING * distance), _FOLLOWING * distance)
    share = speed / (largest * max(distance, 1e-9))
    wanted[0], wanted[1] = x * share, y * share


@compiled
def _move(model: Model, substeps: int, wanted: Array, q: Array, velocity: Array) -> None:
    q[:], velocity[:] = integrate(model, wanted, q, velocity, CONTROL_PERIOD, substeps)


@compiled
def _look(model: Model, q: Array, velocity: Array, tip: Array, tip_velocity: Array) -> None:
    values, rows = task_coordinates(model.chain, q)
    tip[0], tip[1] = values[0] + BASE_X, values[1]
    tip_velocity[:] = product(rows[:2], velocity)
