"""Small convex quadratic programmes behind one call, with three solvers.

    minimise ½ xᵀHx + gᵀx   subject to   lower ≤ Ax ≤ upper

An equality is a row whose bounds coincide. The package's own (`active_set`, exact) can be called from compiled code
and is the default; DAQP is another exact active-set method, OSQP one of first order.
"""

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.control.active_set import SAME, minimise
from airhockey.errors import MissingDependencyError, unknown

Array = NDArray[np.float64]


class QuadraticProgram(Protocol):
    """Anything that solves the problem above."""

    def solve(self, hessian: Array, gradient: Array, rows: Array, lower: Array, upper: Array) -> Array | None:
        """The minimiser, or None where no x satisfies the rows.

        Args:
            hessian: H, symmetric positive definite. Shape (n, n).
            gradient: g. Shape (n,).
            rows: A. Shape (m, n).
            lower: Shape (m,). May hold −∞.
            upper: Shape (m,). May hold ∞.

        Returns:
            x. Shape (n,).
        """


class DualSolver:
    """The package's own dual active-set method."""

    def solve(self, hessian: Array, gradient: Array, rows: Array, lower: Array, upper: Array) -> Array | None:
        """See `QuadraticProgram.solve`."""
        x, found = minimise(hessian, gradient, rows, lower, upper)
        return x if found else None


class DaqpSolver:
    """DAQP: a dual active-set method that ends after finitely many steps, accurate to rounding."""

    _OPTIMAL = 1
    _EQUALITY = 5

    def __init__(self) -> None:
        """Import the solver.

        Raises:
            MissingDependencyError: It is not installed.
        """
        self._solve = _import("daqp").solve

    def solve(self, hessian: Array, gradient: Array, rows: Array, lower: Array, upper: Array) -> Array | None:
        """See `QuadraticProgram.solve`."""
        width = upper - lower
        narrowest = width.min(initial=np.inf)
        if narrowest < -SAME:
            return None
        sense = np.zeros(len(lower), dtype=np.int32)
        if narrowest < SAME:
            sense[width < SAME] = self._EQUALITY
        x, _, flag, _ = self._solve(hessian, gradient, rows, upper, lower, sense, primal_tol=1e-9, iter_limit=200)
        return np.asarray(x) if flag == self._OPTIMAL and np.isfinite(x).all() else None


class OsqpSolver:
    """OSQP: operator splitting; about ten times slower here, accurate to its tolerance."""

    def __init__(self, tolerance: float = 1e-9, max_iterations: int = 20000) -> None:
        """Import the solver.

        Args:
            tolerance: Absolute and relative, of primal and dual residuals.
            max_iterations: After so many the problem counts as unsolved.

        Raises:
            MissingDependencyError: It is not installed.
        """
        self._problem, self._sparse = _import("osqp").OSQP, _import("scipy.sparse").csc_matrix
        self._settings = {
            "eps_abs": tolerance,
            "eps_rel": tolerance,
            "max_iter": max_iterations,
            "polishing": True,
            "verbose": False,
        }

    def solve(self, hessian: Array, gradient: Array, rows: Array, lower: Array, upper: Array) -> Array | None:
        """See `QuadraticProgram.solve`."""
        if np.any(lower > upper + SAME):
            return None
        problem = self._problem()
        problem.setup(
            P=self._sparse(np.triu(hessian)),
            q=np.ascontiguousarray(gradient),
            A=self._sparse(rows),
            l=lower,
            u=np.maximum(upper, lower),
            **self._settings,
        )
        result = problem.solve(raise_error=False)
        return np.asarray(result.x) if result.info.status == "solved" else None


DEFAULT = "dual"
SOLVERS = {"daqp": DaqpSolver, "osqp": OsqpSolver, DEFAULT: DualSolver}


def make_solver(name: str = DEFAULT) -> QuadraticProgram:
    """A solver by name: "dual", "daqp" or "osqp".

    Raises:
        ConfigurationError: Another name.
        MissingDependencyError: It is not installed.
    """
    if name not in SOLVERS:
        raise unknown("QP solver", name, SOLVERS)
    solver: QuadraticProgram = SOLVERS[name]()
    return solver


def _import(module: str) -> Any:
    import importlib

    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        raise MissingDependencyError(f"{module} is not installed: pip install 'airhockey[control]'") from error
