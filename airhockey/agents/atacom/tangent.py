"""Acting on the tangent space: from what a policy wants to what the constraints let it do.

The state is the joint command (q, q̇), the control its acceleration q̈ = diag(q̈_max) u, |u| ≤ 1. Each constraint k(q) ≤ 0
is taken in the viability form c = k + K_f k̇ ≤ 0, joint velocities as they are, with

    ċ = ψ + J_G u,   ψ = k̇ + K_f J̇ q̇,   J_G = K_f J diag(q̈_max)

A slack μ = max(−c, tol) with μ̇ = A(μ) u_μ, A = diag(g (exp(βμ) − 1)), makes it an equality c + μ = 0 on whose tangent
space the control lives. J_u = [J_G A], and with b = ψ + λ (c + μ):

    [u; u_μ] = −J_u⁺ b + P [a; 0],   P = 1 − J_u⁺ J_u

P [I; 0] is the smooth basis of the methods: fixed directions, projected. The slack's part is not needed, and of the rest
Woodbury's identity leaves a system of the size of the arm, whatever the number of constraints:

    u = (1 + J_Gᵀ A⁻² J_G)⁻¹ (a − J_Gᵀ A⁻² b)

Three choices of ours: only a drift towards a limit is compensated (ψ⁺); β and the scale g are each constraint's own; and in
the first term a constraint counts only where that term would use its slack up (see `compensation`). With slacks that resist
in both directions a joint at its largest speed could not brake, and a limit ahead was met by swerving instead.
"""

from math import exp

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.atacom.limits import Limits
from airhockey.agents.compiling import compiled, in_place
from airhockey.agents.small_matrices import factor, solve_backward, solve_forward

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

SMALLEST, LARGEST = 1e-3, 1e3
"""Of A, in units of g: a slack of nothing still moves, and one of plenty is not felt."""
_ROUNDS = 12
"""Of Newton's method; two or three are common."""


@compiled
def slack_rate(slack: float, softness: float) -> float:
    """α(μ) = exp(μ/softness) − 1, the soft corner, within `SMALLEST` … `LARGEST`."""
    return min(max(exp(min(slack / softness, 7.0)) - 1.0, SMALLEST), LARGEST)


@compiled
def constraint_rows(
    limits: Limits, values: Array, rows: Array, drift: Array, q: Array, velocity: Array
) -> tuple[Array, Array, Array, Array]:
    """The constraints at a state.

    Args:
        limits: The bounds.
        values: Task coordinates, in [m]. Shape (r,).
        rows: Their derivatives by the joints. Shape (r, n).
        drift: Their accelerations at q̈ = 0, J̇ q̇, in [m]/[s²]. Shape (r,).
        q, velocity: Joint command, in [rad] and [rad]/[s]. Shapes (n,), (n,).

    Returns:
        c (K,), b = ψ⁺ + λ (c + μ) (K,), J_G (K, n) and A (K,), K = task rows, joint positions up and down, velocities up
        and down.
    """
    n, tasks = q.size, limits.sign.size
    count = tasks + 4 * n
    c, psi, jacobian, softness, scale = (
        np.empty(count),
        np.zeros(count),
        np.zeros((count, n)),
        np.empty(count),
        np.empty(count),
    )
    for i in range(tasks):
        row, sign, time = limits.coordinate[i], limits.sign[i], limits.time[i]
        speed = 0.0
        for j in range(n):
            speed += rows[row, j] * velocity[j]
            jacobian[i, j] = time * sign * rows[row, j] * limits.acceleration[j]
        c[i] = sign * (values[row] - limits.bound[i] + time * speed)
        psi[i] = sign * (speed + time * drift[row])
        softness[i], scale[i] = limits.softness[i], time * limits.tip_acceleration
    for side in range(2):
        sign = 1.0 - 2.0 * side
        for j in range(n):
            i = tasks + side * n + j
            c[i] = sign * (q[j] - limits.position[1 - side, j] + limits.joint_time * velocity[j])
            psi[i] = sign * velocity[j]
            jacobian[i, j] = sign * limits.joint_time * limits.acceleration[j]
            softness[i], scale[i] = limits.joint_softness, limits.joint_time * limits.acceleration[j]
            i += 2 * n
            c[i] = sign * (velocity[j] - limits.velocity[1 - side, j])
            jacobian[i, j] = sign * limits.acceleration[j]
            softness[i], scale[i] = limits.velocity_softness[j], limits.acceleration[j]
    b, a = np.empty(count), np.empty(count)
    for i in range(count):
        slack = max(-c[i], SMALLEST * softness[i])
        b[i] = max(psi[i], 0.0) + limits.contraction * (c[i] + slack)
        a[i] = scale[i] * slack_rate(slack, softness[i])
    return c, b, jacobian, a


@compiled
def tangent_control(action: Array, b: Array, jacobian: Array, a: Array) -> Array:
    """The control: what drift and contraction ask for, and as much of the action's tangent part as |u| ≤ 1 leaves room for.

    Args:
        action: What the policy wants, in units of the joints' largest accelerations. Shape (n,).
        b, jacobian, a: From `constraint_rows`. Shapes (K,), (K, n), (K,).

    Returns:
        u, each of its entries in [−1, 1]. Shape (n,).
    """
    n = action.size
    every = np.ones(b.size, dtype=np.bool_)
    tangent = action.copy()
    _solve(_gram(every, jacobian, a), tangent)
    control, room = compensation(b, jacobian, a), 1.0
    for j in range(n):
        control[j] = min(max(control[j], -1.0), 1.0)
        if abs(tangent[j]) > 1e-12:
            room = min(room, ((1.0 if tangent[j] > 0.0 else -1.0) - control[j]) / tangent[j])
    return control + room * tangent


@compiled
def compensation(b: Array, jacobian: Array, a: Array) -> Array:
    """The smallest control that makes up for drift and contraction: argmin ½‖u‖² + ½‖A⁻¹ (J_G u + b)⁺‖².

    A constraint whose slack the control lets grow does not resist it: a joint at its largest speed may always brake. The
    rows that count are found by Newton's method, which ends where they stay the same. Shape (n,).
    """
    counts = b > 0.0
    control = np.zeros(jacobian.shape[1])
    for _ in range(_ROUNDS):
        control[:] = 0.0
        for i in range(b.size):
            if counts[i]:
                for j in range(control.size):
                    control[j] -= jacobian[i, j] * (b[i] / (a[i] * a[i]))
        _solve(_gram(counts, jacobian, a), control)
        same = True
        for i in range(b.size):
            rate = b[i]
            for j in range(control.size):
                rate += jacobian[i, j] * control[j]
            same = same and counts[i] == (rate > 0.0)
            counts[i] = rate > 0.0
        if same:
            break
    return control


@in_place
def _solve(matrix: Array, right: Array) -> None:
    """Replace a right side by matrix⁻¹ times it, and a positive definite matrix by its factor. Shapes (n, n), (n,)."""
    factor(matrix)
    solve_forward(matrix, right)
    solve_backward(matrix, right)


@compiled
def _gram(counts: Flags, jacobian: Array, a: Array) -> Array:
    """1 + J_Gᵀ A⁻² J_G over the rows that count. Shape (n, n)."""
    n = jacobian.shape[1]
    matrix = np.eye(n)
    for i in range(a.size):
        if counts[i]:
            weight = 1.0 / (a[i] * a[i])
            for j in range(n):
                scaled = weight * jacobian[i, j]
                if scaled != 0.0:
                    for k in range(n):
                        matrix[j, k] += scaled * jacobian[i, k]
    return matrix
