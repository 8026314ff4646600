"""AQP against brute force over its null space, each limit absent, active and contradictory, and every solver."""

import numpy as np
import pytest
from scipy.optimize import minimize

from airhockey.agents.control.aqp import AnchoredQp, VelocityLimits
from airhockey.agents.control.kinematics import ArmKinematics
from airhockey.agents.control.qp import make_solver
from airhockey.agents.control.speed_limit import largest_speed
from airhockey.envs.specs import IIWA, PLANAR

WEIGHTS = np.array([10.0, 1.0, 10.0, 1.0, 10.0, 10.0, 1.0])
NO_ROWS = (np.empty((0, 7)), np.empty(0))


def posture(seed):
    kinematics = ArmKinematics(IIWA)
    rng = np.random.default_rng(seed)
    return kinematics, np.array(IIWA.start) + rng.uniform(-0.3, 0.3, 7), rng


def free():
    return VelocityLimits(np.full(7, -np.inf), np.full(7, np.inf), *NO_ROWS)


def brute_force(jacobian, velocity, anchor, limits):
    """SLSQP on q̇ itself, from many starts: another formulation and another method."""
    rows, lower = limits.rows, limits.row_lower
    conditions = [{"type": "eq", "fun": lambda v: jacobian @ v - velocity, "jac": lambda v: jacobian}]
    if len(lower):
        conditions.append({"type": "ineq", "fun": lambda v: rows @ v - lower, "jac": lambda v: rows})
    best = None
    for start in (np.zeros(7), anchor, np.linalg.pinv(jacobian) @ velocity):
        result = minimize(
            lambda v: 0.5 * WEIGHTS @ (v - anchor) ** 2,
            np.clip(start, limits.lower, limits.upper),
            jac=lambda v: WEIGHTS * (v - anchor),
            bounds=list(zip(limits.lower, limits.upper, strict=True)),
            constraints=conditions,
            method="SLSQP",
            options={"ftol": 1e-14, "maxiter": 500},
        )
        if result.success and (best is None or result.fun < best.fun):
            best = result
    return best.x


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("solver", ["daqp", "osqp", "dual"])
def test_equals_brute_force(seed, solver):
    kinematics, q, rng = posture(seed)
    jacobian = kinematics.jacobian(q)
    velocity = np.array([*rng.uniform(-0.7, 0.7, 2), 0.0])
    anchor = rng.uniform(-0.5, 0.5, 7)
    _, rows = kinematics.link_heights_and_jacobian(q)
    limits = VelocityLimits(*(0.9 * IIWA.joint_velocity_limit), rows, np.full(2, -0.05))
    answer = AnchoredQp(WEIGHTS, make_solver(solver)).solve(jacobian, velocity, anchor, limits)
    expected = brute_force(jacobian, velocity, anchor, limits)
    np.testing.assert_allclose(jacobian @ answer, velocity, atol=1e-7)
    np.testing.assert_allclose(answer, expected, atol=1e-4)


def test_an_anchor_in_reach_is_met_exactly():
    kinematics, q, rng = posture(9)
    jacobian = kinematics.jacobian(q)
    anchor = rng.uniform(-0.2, 0.2, 7)
    answer = AnchoredQp(WEIGHTS, make_solver()).solve(jacobian, jacobian @ anchor, anchor, free())
    np.testing.assert_allclose(answer, anchor, atol=1e-9)


def test_a_velocity_limit_that_is_active_is_kept_and_the_tip_still_moves_as_asked():
    kinematics, q, _ = posture(10)
    jacobian = kinematics.jacobian(q)
    velocity, anchor = np.array([0.3, 0.1, 0.0]), np.zeros(7)
    qp = AnchoredQp(WEIGHTS, make_solver())
    unlimited = qp.solve(jacobian, velocity, anchor, free())
    bound = np.full(7, np.inf)
    bound[1] = 0.8 * abs(unlimited[1])
    answer = qp.solve(jacobian, velocity, anchor, VelocityLimits(-bound, bound, *NO_ROWS))
    assert abs(answer[1]) == pytest.approx(bound[1])
    np.testing.assert_allclose(jacobian @ answer, velocity, atol=1e-9)


def test_a_height_row_holds_the_wrist_up():
    kinematics, q, _ = posture(11)
    jacobian = kinematics.jacobian(q)
    _, rows = kinematics.link_heights_and_jacobian(q)
    qp = AnchoredQp(WEIGHTS, make_solver())
    velocity = np.array([0.5, 0.0, 0.0])
    sinking = rows @ qp.solve(jacobian, velocity, np.zeros(7), free())
    least = sinking + 0.01  # both sink more slowly than they would
    limits = VelocityLimits(np.full(7, -np.inf), np.full(7, np.inf), rows, least)
    held = qp.solve(jacobian, velocity, np.zeros(7), limits)
    assert np.all(rows @ held >= least - 1e-9)
    np.testing.assert_allclose(jacobian @ held, velocity, atol=1e-9)


def test_too_fast_is_infeasible_and_the_relaxed_problem_slows_down_along_the_line():
    kinematics, q, _ = posture(12)
    jacobian = kinematics.jacobian(q)
    limits = VelocityLimits(*(0.9 * IIWA.joint_velocity_limit), *NO_ROWS)
    qp = AnchoredQp(WEIGHTS, make_solver())
    fastest = largest_speed(jacobian, np.array([1.0, 0.0, 0.0]), limits.lower, limits.upper)
    velocity = np.array([1.2 * fastest, 0.0, 0.0])
    assert qp.solve(jacobian, velocity, np.zeros(7), limits) is None
    slower = qp.solve_relaxed(jacobian, velocity, np.zeros(7), limits, np.diag([1e5, 1e6, 1e8]))
    assert np.all(slower >= limits.lower - 1e-9) and np.all(slower <= limits.upper + 1e-9)
    tip = jacobian @ slower
    assert tip[0] > 0.95 * fastest and abs(tip[1]) < 0.1 * tip[0] and abs(tip[2]) < 0.02


def test_a_singular_jacobian_is_not_tried():
    jacobian = np.zeros((3, 7))
    jacobian[0, 0] = 1.0
    assert AnchoredQp(WEIGHTS, make_solver()).solve(jacobian, np.ones(3), np.zeros(7), free()) is None


def test_without_a_null_space_the_answer_is_the_only_one():
    kinematics = ArmKinematics(PLANAR)
    jacobian = kinematics.jacobian(np.array(PLANAR.start))[:2, :2]
    qp = AnchoredQp(np.ones(2), make_solver())
    wide = VelocityLimits(np.full(2, -9.0), np.full(2, 9.0), np.empty((0, 2)), np.empty(0))
    np.testing.assert_allclose(
        qp.solve(jacobian, np.array([0.1, 0.2]), np.zeros(2), wide), np.linalg.solve(jacobian, [0.1, 0.2])
    )
    tight = VelocityLimits(np.full(2, -1e-3), np.full(2, 1e-3), np.empty((0, 2)), np.empty(0))
    assert qp.solve(jacobian, np.array([0.1, 0.2]), np.zeros(2), tight) is None
