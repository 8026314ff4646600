"""The largest speed of the rod tip along a direction: a linear programme, solved exactly by enumeration.

    maximise η   subject to   J q̇ = η d,   lower ≤ q̇ ≤ upper

(Liu, Tateo, Bou-Ammar and Peters, "Efficient and Reactive Planning for High Speed Robot Air Hockey", IROS 2021.)
Its dual asks for the direction y with y·d = 1 along which the reachable velocities extend least:

    minimise Σ_k max(lower_k a_k, upper_k a_k)   with   a = Jᵀ y.

The dual objective is piecewise linear, so its minimum lies where y is orthogonal to as many columns of J as y has
freedoms left: two of the iiwa's seven (21 candidates), one of the planar robot's three.
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.control.qp import QuadraticProgram

Array = NDArray[np.float64]

_FLAT = 1e-9
"""Candidates whose component along d is smaller than this are no candidates: y·d = 1 is out of their reach."""
_REACHABLE = 1.0 - 1e-6
"""Share of the largest speed asked of the QP, so that rounding does not make it infeasible."""


def largest_speed(jacobian: Array, direction: Array, lower: Array, upper: Array) -> float:
    """The largest speed of the rod tip along a direction, in [m]/[s].

    Args:
        jacobian: Position Jacobian of the rod tip, without rows that vanish. Shape (m, n), m = 2 or 3.
        direction: Unit vector d. Shape (m,).
        lower: Least joint velocities, not above 0, in [rad]/[s]. Shape (n,).
        upper: Largest joint velocities, not below 0, in [rad]/[s]. Shape (n,).
    """
    candidates = _candidates(jacobian)
    along = candidates @ direction
    usable = np.abs(along) > _FLAT * np.linalg.norm(candidates, axis=1)
    if not usable.any():
        return 0.0
    support = (candidates[usable] / along[usable, None]) @ jacobian
    return float(np.maximum(support * lower, support * upper).sum(axis=1).min())


def fastest_joint_velocity(
    jacobian: Array, direction: Array, lower: Array, upper: Array, solver: QuadraticProgram
) -> tuple[float, Array]:
    """The largest speed, and the least joint velocity that reaches it (to one part in a million).

    Args:
        jacobian, direction, lower, upper: As for `largest_speed`.
        solver: Finds the shortest q̇ on the face of the box where the maximum is reached.

    Returns:
        Speed in [m]/[s] and joint velocities in [rad]/[s]. Shape (n,).
    """
    n = jacobian.shape[1]
    speed = largest_speed(jacobian, direction, lower, upper) * _REACHABLE
    velocity = solver.solve(
        np.eye(n),
        np.zeros(n),
        np.vstack([np.eye(n), jacobian]),
        np.concatenate([lower, speed * direction]),
        np.concatenate([upper, speed * direction]),
    )
    return (speed, velocity) if velocity is not None else (0.0, np.zeros(n))


def _candidates(jacobian: Array) -> Array:
    """Vectors orthogonal to one (m = 2) or to two (m = 3) columns of J. Shape (c, m)."""
    if jacobian.shape[0] == 2:
        return np.stack([-jacobian[1], jacobian[0]], axis=1)
    first, second = _pairs(jacobian.shape[1])
    a, b = jacobian[:, first], jacobian[:, second]
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]], axis=1)


@cache
def _pairs(n: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    first, second = np.triu_indices(n, k=1)
    return first, second
