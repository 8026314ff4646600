"""The largest speed of the rod tip along a direction: a linear programme, solved exactly by enumeration.

    maximise η   subject to   J q̇ = η d,   lower ≤ q̇ ≤ upper

(Liu, Tateo, Bou-Ammar and Peters, "Efficient and Reactive Planning for High Speed Robot Air Hockey", IROS 2021.)
Its dual asks for the direction y with y·d = 1 along which the reachable velocities extend least:

    minimise Σ_k max(lower_k a_k, upper_k a_k)   with   a = Jᵀ y.

The dual objective is piecewise linear, so its minimum lies where y is orthogonal to as many columns of J as y has
freedoms left: two of the iiwa's seven (21 candidates), one of the planar robot's three.
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.control.qp import QuadraticProgram

Array = NDArray[np.float64]

_FLAT = 1e-9
"""Candidates whose component along d is smaller than this are no candidates: y·d = 1 is out of their reach."""
_REACHABLE = 1.0 - 1e-6
"""Share of the largest speed asked of the QP, so that rounding does not make it infeasible."""


@compiled
def largest_speed(jacobian: Array, direction: Array, lower: Array, upper: Array) -> float:
    """The largest speed of the rod tip along a direction, in [m]/[s].

    Args:
        jacobian: Position Jacobian of the rod tip, without rows that vanish. Shape (m, n), m = 2 or 3.
        direction: Unit vector d. Shape (m,).
        lower: Least joint velocities, not above 0, in [rad]/[s]. Shape (n,).
        upper: Largest joint velocities, not below 0, in [rad]/[s]. Shape (n,).
    """
    m, n = jacobian.shape
    least = np.inf
    for i in range(n):
        for j in range(i + 1, n if m == 3 else i + 2):  # the planar robot's y is orthogonal to column i alone
            candidate = _orthogonal(jacobian, i, j)
            along, length = 0.0, 0.0
            for c in range(m):
                along += candidate[c] * direction[c]
                length += candidate[c] * candidate[c]
            if abs(along) > _FLAT * sqrt(length):
                least = min(least, _extent(jacobian, candidate, lower, upper, along))
    return least if least < np.inf else 0.0


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


@compiled
def _orthogonal(jacobian: Array, i: int, j: int) -> Array:
    """A vector orthogonal to column i of J, where columns have three entries also to column j. Shape (m,)."""
    if jacobian.shape[0] == 2:
        return np.array([-jacobian[1, i], jacobian[0, i]])
    a0, a1, a2 = jacobian[0, i], jacobian[1, i], jacobian[2, i]
    b0, b1, b2 = jacobian[0, j], jacobian[1, j], jacobian[2, j]
    return np.array([a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0])


@compiled
def _extent(jacobian: Array, candidate: Array, lower: Array, upper: Array, along: float) -> float:
    """The dual objective Σ_k max(lower_k a_k, upper_k a_k) of y = candidate / along."""
    total = 0.0
    for k in range(jacobian.shape[1]):
        a = 0.0
        for c in range(len(candidate)):
            a += jacobian[c, k] * candidate[c]
        a /= along
        total += max(lower[k] * a, upper[k] * a)
    return total
