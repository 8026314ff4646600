"""Anchored quadratic programming (AQP): a velocity of the rod tip → a joint velocity, its redundancy held by an anchor.

Liu, Tateo, Bou-Ammar and Peters, "Efficient and Reactive Planning for High Speed Robot Air Hockey" (IROS 2021).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.control.qp import QuadraticProgram

Array = NDArray[np.float64]

SINGULAR = 1e-6
"""A Jacobian with a singular value below this, in [m]/[rad], counts as singular: the exact problem is not tried."""


@dataclass(frozen=True)
class VelocityLimits:
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

    def with_rows(self, rows: Array, row_lower: Array) -> "VelocityLimits":
        """These limits and more rows. Shapes (j, n), (j,)."""
        return VelocityLimits(
            self.lower, self.upper, np.vstack([self.rows, rows]), np.concatenate([self.row_lower, row_lower])
        )


class AnchoredQp:
    """Chooses among the joint velocities that move the rod tip as asked the one closest to the anchor.

    With b = J⁺v and N an orthonormal basis of the null space of J:

        minimise over α  ½ ‖b + Nα − q̇_anchor‖²_W   subject to   lower ≤ b + Nα ≤ upper,   rows (b + Nα) ≥ row_lower
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
        m = jacobian.shape[0]
        u, s, vt = np.linalg.svd(jacobian)
        if s[-1] < SINGULAR:
            return None
        b = ((u.T @ velocity) / s) @ vt[:m]
        basis = vt[m:].T
        if basis.shape[1] == 0:
            return b if _within(b, limits) else None
        weighted = basis.T * self.weights
        alpha = self._solver.solve(
            np.ascontiguousarray(weighted @ basis),
            weighted @ (b - anchor),
            np.concatenate([basis, limits.rows @ basis]),
            np.concatenate([limits.lower - b, limits.row_lower - limits.rows @ b]),
            np.concatenate([limits.upper - b, np.full(len(limits.row_lower), np.inf)]),
        )
        return None if alpha is None else b + basis @ alpha

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
        n = jacobian.shape[1]
        pull = jacobian.T @ tracking
        return self._solver.solve(
            pull @ jacobian + np.diag(self.weights),
            -(pull @ velocity + self.weights * anchor),
            np.concatenate([np.eye(n), limits.rows]),
            np.concatenate([limits.lower, limits.row_lower]),
            np.concatenate([limits.upper, np.full(len(limits.row_lower), np.inf)]),
        )


def _within(velocity: Array, limits: VelocityLimits, tolerance: float = 1e-9) -> bool:
    return bool(
        np.all(velocity >= limits.lower - tolerance)
        and np.all(velocity <= limits.upper + tolerance)
        and np.all(limits.rows @ velocity >= limits.row_lower - tolerance)
    )
