"""A dual active-set method for small strictly convex quadratic programmes, compiled.

    minimise ½ xᵀHx + gᵀx   subject to   lower ≤ Ax ≤ upper

Goldfarb and Idnani, "A numerically stable dual method for solving strictly convex quadratic programs", Mathematical
Programming 27 (1983). With H = L Lᵀ and u = Lᵀx + L⁻¹g it is the search for the shortest u between bounds. It starts from the
unconstrained minimum, u = 0, and adds the row that is violated most, one after the other, dropping those whose multipliers would
change sign; it ends after finitely many steps, at the minimum or where a row cannot be satisfied.

The rows held, at most n, are kept as Q R with Q orthonormal. R is so small that it is made anew when a row is dropped.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled, in_place
from airhockey.agents.small_matrices import factor, solve_backward, solve_forward

Array = NDArray[np.float64]

SAME = 1e-12
"""Bounds closer than this make a row an equality, which is never dropped."""
TOLERANCE = 1e-10
"""By how much a row, scaled to length 1 in u, may be violated."""
DEPENDENT = 1e-10
"""A row of length 1 with less than this orthogonal to the rows held depends on them."""
ITERATIONS = 200


class Rows(NamedTuple):
    """The rows scaled to length 1, as they are in u.

    Attributes:
        normal: Shape (m, n).
        low, high: Their bounds. Shapes (m,).
    """

    normal: Array
    low: Array
    high: Array


class ActiveSet(NamedTuple):
    """The rows held at one of their bounds.

    Attributes:
        row: Their numbers. Shape (n,).
        sign: 1 where a row is held at its lower bound, −1 at its upper one. Shape (n,).
        bound: sign times that bound, in u. Shape (n,).
        multiplier: Shape (n,).
        basis: Qᵀ, and in the row after it the rest of the row that is looked at. Shape (n + 1, n).
        corner: R, with the same row in its last column. Shape (n + 1, n + 1).
        along: Room for R⁻¹ times a column. Shape (n,).
    """

    row: NDArray[np.int64]
    sign: Array
    bound: Array
    multiplier: Array
    basis: Array
    corner: Array
    along: Array


@compiled
def minimise(hessian: Array, gradient: Array, rows: Array, lower: Array, upper: Array) -> tuple[Array, bool]:
    """Solve the problem above.

    Args:
        hessian: H, symmetric positive definite. Shape (n, n).
        gradient: g. Shape (n,).
        rows: A. Shape (m, n).
        lower: Shape (m,). May hold −∞.
        upper: Shape (m,). May hold ∞.

    Returns:
        x, shape (n,), and whether it is the minimum; where it is not, no x satisfies the rows, or H is not positive definite.
    """
    n, m = len(gradient), len(lower)
    root, x = hessian.copy(), gradient.copy()
    if not factor(root):
        return x, False
    for i in range(m):
        if upper[i] - lower[i] < -SAME:
            return x, False
    solve_forward(root, x)
    scaled = _shortest_vector_problem(root, x, rows, lower, upper)
    u = np.zeros(n)
    held = ActiveSet(
        np.zeros(n, np.int64),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros((n + 1, n)),
        np.zeros((n + 1, n + 1)),
        np.empty(n),
    )
    count, found = 0, False
    for _ in range(ITERATIONS):
        row, sign = _most_violated(scaled, u)
        if row < 0:
            found = True
            break
        count = _add_row(row, sign, scaled, u, held, count)
        if count < 0:
            break
    for i in range(n):
        x[i] = u[i] - x[i]
    solve_backward(root, x)
    return x, found


@compiled
def _shortest_vector_problem(root: Array, shift: Array, rows: Array, lower: Array, upper: Array) -> Rows:
    """The rows in u = Lᵀx + shift."""
    m, n = rows.shape
    scaled, low, high = rows.copy(), np.empty(m), np.empty(m)
    for i in range(m):
        row = scaled[i]
        solve_forward(root, row)
        length, offset = 0.0, 0.0
        for k in range(n):
            length += row[k] * row[k]
            offset += row[k] * shift[k]
        scale = 1.0 / np.sqrt(length) if length > 1e-28 else 1.0
        for k in range(n):
            row[k] *= scale
        low[i], high[i] = (lower[i] + offset) * scale, (upper[i] + offset) * scale
    return Rows(scaled, low, high)


@in_place
def _most_violated(rows: Rows, u: Array) -> tuple[int, float]:
    """Number of the row that u violates most, or −1; and 1 if it is below its lower bound, −1 if above its upper one."""
    scaled, low, high = rows
    worst, which, sign = TOLERANCE, -1, 1.0
    for i in range(len(low)):
        value = 0.0
        for k in range(len(u)):
            value += scaled[i, k] * u[k]
        if low[i] - value > worst:
            worst, which, sign = low[i] - value, i, 1.0
        if value - high[i] > worst:
            worst, which, sign = value - high[i], i, -1.0
    return which, sign


@in_place
def _add_row(row: int, sign: float, rows: Rows, u: Array, held: ActiveSet, count: int) -> int:
    """Add a violated row to those held, moving u in place until it holds, and drop those in the way.

    Args:
        row, sign: From `_most_violated`.
        rows: All of them.
        u: Shape (n,).
        held: The rows held so far.
        count: Their number.

    Returns:
        The number of rows held then; −1 if the row cannot hold.
    """
    (scaled, low, high), along, n, multiplier = rows, held.along, len(u), 0.0
    bound = low[row] if sign > 0.0 else -high[row]
    for _ in range(ITERATIONS):
        length = _append(held, count, scaled[row], sign)
        violation = bound
        for k in range(n):
            violation -= sign * scaled[row, k] * u[k]
        _shares(held, count, along)
        limit, blocking = np.inf, -1  # how far until a row's multiplier is used up
        for j in range(count):
            droppable = high[held.row[j]] - low[held.row[j]] > SAME
            if droppable and along[j] > 0.0 and held.multiplier[j] < limit * along[j]:
                limit, blocking = held.multiplier[j] / along[j], j
        full = violation / (length * length) if length > DEPENDENT else np.inf
        step = min(limit, full)
        if step == np.inf:
            return -1
        multiplier += step
        for j in range(count):
            held.multiplier[j] -= step * along[j]
        if full <= limit:
            for k in range(n):
                held.basis[count, k] /= length
            held.corner[count, count] = length
            held.row[count], held.sign[count] = row, sign
            held.bound[count], held.multiplier[count] = bound, multiplier
            _settle(held, count + 1, u, along)
            return count + 1
        if length > DEPENDENT:
            for k in range(n):
                u[k] += step * held.basis[count, k]
        count = _drop(held, count, blocking, scaled)
    return -1


@in_place
def _append(held: ActiveSet, count: int, row: Array, sign: float) -> float:
    """Split sign · row into what the rows held span (column `count` of R) and the rest (row `count` of Qᵀ). Gives its length."""
    n, rest = len(row), held.basis[count]
    for k in range(n):
        rest[k] = sign * row[k]
    for j in range(count):
        held.corner[j, count] = 0.0
    for _ in range(2):  # twice is enough for orthogonality to rounding
        for j in range(count):
            share = 0.0
            for k in range(n):
                share += held.basis[j, k] * rest[k]
            held.corner[j, count] += share
            for k in range(n):
                rest[k] -= share * held.basis[j, k]
    length = 0.0
    for k in range(n):
        length += rest[k] * rest[k]
    return float(np.sqrt(length))


@in_place
def _shares(held: ActiveSet, count: int, along: Array) -> None:
    """Write R⁻¹ times column `count` of R: how the last row is made of those held."""
    for j in range(count):
        i = count - 1 - j
        rest = held.corner[i, count]
        for k in range(i + 1, count):
            rest -= held.corner[i, k] * along[k]
        along[i] = rest / held.corner[i, i]


@in_place
def _settle(held: ActiveSet, count: int, u: Array, work: Array) -> None:
    """Write the shortest u that has every row held at its bound."""
    for k in range(len(u)):
        u[k] = 0.0
    for i in range(count):
        rest = held.bound[i]
        for j in range(i):
            rest -= held.corner[j, i] * work[j]
        work[i] = rest / held.corner[i, i]
        for k in range(len(u)):
            u[k] += work[i] * held.basis[i, k]


@in_place
def _drop(held: ActiveSet, count: int, place: int, scaled: Array) -> int:
    """Forget the row held at a place. Returns the number of rows still held."""
    for j in range(place, count - 1):
        held.row[j], held.sign[j] = held.row[j + 1], held.sign[j + 1]
        held.bound[j], held.multiplier[j] = held.bound[j + 1], held.multiplier[j + 1]
        length = _append(held, j, scaled[held.row[j]], held.sign[j])
        held.corner[j, j] = length
        for k in range(scaled.shape[1]):
            held.basis[j, k] /= length
    return count - 1
