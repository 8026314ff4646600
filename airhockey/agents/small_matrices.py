"""Small matrices in loops: for a handful of rows they cost less than calls of BLAS and LAPACK, and compile faster.

And threads do not wait for each other in them, as they do in numba's `@` and `np.linalg.solve`.
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled, in_place

Array = NDArray[np.float64]


@in_place
def factor(matrix: Array) -> bool:
    """Replace the lower triangle of a symmetric matrix by L with L Lᵀ = matrix.

    Args:
        matrix: Only its lower triangle is read. Shape (n, n).

    Returns:
        Whether the matrix is positive definite; where it is not, what is left in it has no meaning.
    """
    for i in range(len(matrix)):
        for j in range(i + 1):
            rest = matrix[i, j]
            for k in range(j):
                rest -= matrix[i, k] * matrix[j, k]
            if j < i:
                matrix[i, j] = rest / matrix[j, j]
            elif rest > 0.0:
                matrix[i, i] = sqrt(rest)
            else:
                return False
    return True


@in_place
def solve_forward(lower: Array, right: Array) -> None:
    """Replace a right side by L⁻¹ times it. Shapes (n, n), (n,)."""
    for i in range(len(right)):
        rest = right[i]
        for k in range(i):
            rest -= lower[i, k] * right[k]
        right[i] = rest / lower[i, i]


@in_place
def solve_backward(lower: Array, right: Array) -> None:
    """Replace a right side by L⁻ᵀ times it. Shapes (n, n), (n,)."""
    n = len(right)
    for j in range(n):
        i = n - 1 - j
        rest = right[i]
        for k in range(i + 1, n):
            rest -= lower[k, i] * right[k]
        right[i] = rest / lower[i, i]


@in_place
def add_congruence(result: Array, matrix: Array, middle: Array) -> None:
    """Add A M Aᵀ to a result, in place. Shapes (n, n), A (n, m), M (m, m)."""
    n, m = matrix.shape
    for i in range(n):
        for k in range(m):
            product = 0.0  # (A M)_ik
            for j in range(m):
                product += matrix[i, j] * middle[j, k]
            for j in range(n):
                result[i, j] += product * matrix[j, k]


@compiled
def product(matrix: Array, vector: Array) -> Array:
    """A matrix times a vector. Shapes (m, n), (n,) → (m,)."""
    result = np.zeros(matrix.shape[0])
    for i in range(matrix.shape[0]):
        for j in range(matrix.shape[1]):
            result[i] += matrix[i, j] * vector[j]
    return result
