"""Anchored quadratic programming (AQP): a velocity of the rod tip → a joint velocity, its redundancy held by an anchor.

Liu, Tateo, Bou-Ammar and Peters, "Efficient and Reactive Planning for High Speed Robot Air Hockey" (IROS 2021). They write
q̇ = b + Nα with b = J⁺v and N a basis of the null space of J, and choose α; here the same q̇ is found without a basis, with
J q̇ = v as equalities.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.control.qp import QuadraticProgram
from airhockey.agents.small_matrices import factor

Array = NDArray[np.float64]

SINGULAR = 1e-6
"""A Jacobian with a singular value below this, in [m]/[rad], counts as singular: the exact problem is not tried."""


class VelocityLimits(NamedTuple):
    """What a joint velocity must satisfy: lower ≤ q̇ ≤ upper, and rows · q̇ ≥ row_lower.

    Attributes:
        lower, upper: In [rad]/[s]. Shape (n,).
        rows: Jacobians of heights that must not shrink too fast, in [m]/[rad]. Shape (k, n).
        row_lower: Least velocities of those heights, in [m]/[s]. Shape (k,).
    """

    lower: Array
    upper: Array
    rows: Array
    row_lower: Array


class Problem(NamedTuple):
    """A quadratic programme, as `QuadraticProgram.solve` takes it."""

    hessian: Array
    gradient: Array
    rows: Array
    lower: Array
    upper: Array


class AnchoredQp:
    """Chooses among the joint velocities that move the rod tip as asked the one closest to the anchor.

    minimise  ½ ‖q̇ − q̇_anchor‖²_W   subject to   J q̇ = v,   lower ≤ q̇ ≤ upper,   rows q̇ ≥ row_lower
    """

    def __init__(self, weights: Array, solver: QuadraticProgram) -> None:
        """Keep the metric and the solver.

        Args:
            weights: Diagonal of W, how strongly each joint holds to the anchor. Shape (n,).
            solver: Solves the QPs.
        """
        self.weights = np.asarray(weights, dtype=float)
        self._solver = solver

    def solve(self, jacobian: Array, velocity: Array, anchor: Array, limits: VelocityLimits) -> Array | None:
        """The joint velocity that moves the rod tip exactly as asked.

        Args:
            jacobian: J, without rows that vanish. Shape (m, n).
            velocity: v, velocity of the rod tip, in [m]/[s]. Shape (m,).
            anchor: q̇_anchor, in [rad]/[s]. Shape (n,).
            limits: The inequalities.

        Returns:
            q̇ in [rad]/[s], shape (n,); None where the limits do not allow v, or J is singular.
        """
        if is_singular(jacobian):
            return None
        return self._solver.solve(*exact_problem(jacobian, velocity, anchor, limits, self.weights))

    def solve_relaxed(
        self, jacobian: Array, velocity: Array, anchor: Array, limits: VelocityLimits, tracking: Array
    ) -> Array | None:
        """The joint velocity within the limits that moves the rod tip most nearly as asked.

            minimise over q̇  ½ (J q̇ − v)ᵀ T (J q̇ − v) + ½ ‖q̇ − q̇_anchor‖²_W   subject to the limits

        Args:
            jacobian, velocity, anchor, limits: As for `solve`.
            tracking: T, symmetric positive semi-definite: how much each error of the tip's velocity counts. Shape (m,
                m).

        Returns:
            q̇ in [rad]/[s], shape (n,); None where the limits contradict one another.
        """
        return self._solver.solve(*relaxed_problem(jacobian, velocity, anchor, limits, tracking, self.weights))


@compiled
def is_singular(jacobian: Array) -> bool:
    """Whether J has a singular value below `SINGULAR`: J Jᵀ − SINGULAR² I is not positive definite then. Shape (m, n)."""
    m, n = jacobian.shape
    gram = np.zeros((m, m))
    for i in range(m):
        for j in range(i + 1):
            for k in range(n):
                gram[i, j] += jacobian[i, k] * jacobian[j, k]
        gram[i, i] -= SINGULAR * SINGULAR
    return not factor(gram)


@compiled
def exact_problem(jacobian: Array, velocity: Array, anchor: Array, limits: VelocityLimits, weights: Array) -> Problem:
    """The problem of `AnchoredQp.solve`, whose arguments these are."""
    m, n = jacobian.shape
    problem = _limited(limits, m)
    for i in range(n):
        problem.hessian[i, i] = weights[i]
        problem.gradient[i] = -weights[i] * anchor[i]
    for i in range(m):
        problem.rows[i] = jacobian[i]
        problem.lower[i] = problem.upper[i] = velocity[i]
    return problem


@compiled
def relaxed_problem(
    jacobian: Array, velocity: Array, anchor: Array, limits: VelocityLimits, tracking: Array, weights: Array
) -> Problem:
    """The problem of `AnchoredQp.solve_relaxed`, whose arguments these are."""
    m, n = jacobian.shape
    problem = _limited(limits, 0)
    for i in range(n):
        problem.hessian[i, i] = weights[i]
        problem.gradient[i] = -weights[i] * anchor[i]
        for a in range(m):
            pull = 0.0
            for b in range(m):
                pull += tracking[a, b] * jacobian[b, i]
            problem.gradient[i] -= pull * velocity[a]
            for j in range(n):
                problem.hessian[i, j] += pull * jacobian[a, j]
    return problem


@compiled
def _limited(limits: VelocityLimits, first: int) -> Problem:
    """A problem of which only the limits are written, after so many rows left free."""
    k, n = limits.rows.shape
    size = first + n + k
    problem = Problem(np.zeros((n, n)), np.zeros(n), np.zeros((size, n)), np.empty(size), np.full(size, np.inf))
    for i in range(n):
        problem.rows[first + i, i] = 1.0
        problem.lower[first + i], problem.upper[first + i] = limits.lower[i], limits.upper[i]
    for i in range(k):
        problem.rows[first + n + i] = limits.rows[i]
        problem.lower[first + n + i] = limits.row_lower[i]
    return problem
