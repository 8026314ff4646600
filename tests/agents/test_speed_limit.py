"""The largest speed against scipy's linear programming."""

import numpy as np
import pytest
from scipy.optimize import linprog

from airhockey.agents.control.kinematics import ArmKinematics
from airhockey.agents.control.qp import make_solver
from airhockey.agents.control.speed_limit import fastest_joint_velocity, largest_speed
from airhockey.envs.specs import IIWA, PLANAR


def by_linprog(jacobian, direction, lower, upper):
    m, n = jacobian.shape
    result = linprog(
        np.r_[np.zeros(n), -1.0],
        A_eq=np.c_[jacobian, -direction],
        b_eq=np.zeros(m),
        bounds=[*zip(lower, upper, strict=True), (None, None)],
    )
    return -result.fun


@pytest.mark.parametrize("spec", [IIWA, PLANAR], ids=["iiwa", "planar"])
def test_equals_the_linear_programme(spec):
    kinematics, solver, rng = ArmKinematics(spec), make_solver(), np.random.default_rng(4)
    m = kinematics.n_coordinates
    for trial in range(60):
        q = np.array(spec.start) if trial < 5 else rng.uniform(*spec.joint_position_limit)
        angle = 0.0 if trial == 0 else rng.uniform(-np.pi, np.pi)
        jacobian, direction = kinematics.jacobian(q)[:m], np.array([np.cos(angle), np.sin(angle), 0.0])[:m]
        lower = spec.joint_velocity_limit[0] * rng.uniform(0.2, 1.0, spec.n_joints)
        upper = spec.joint_velocity_limit[1] * rng.uniform(0.2, 1.0, spec.n_joints)
        expected = by_linprog(jacobian, direction, lower, upper)
        assert largest_speed(jacobian, direction, lower, upper) == pytest.approx(expected, abs=1e-7)
        speed, velocity = fastest_joint_velocity(jacobian, direction, lower, upper, solver)
        assert speed == pytest.approx(expected, abs=1e-5)
        np.testing.assert_allclose(jacobian @ velocity, speed * direction, atol=1e-7)
        assert np.all(velocity >= lower - 1e-9) and np.all(velocity <= upper + 1e-9)


def test_a_direction_that_the_joints_cannot_move_has_speed_zero():
    jacobian = np.array([[1.0, 0.5, 2.0], [0.0, 0.0, 0.0]])
    assert largest_speed(jacobian, np.array([0.0, 1.0]), -np.ones(3), np.ones(3)) == pytest.approx(0.0)
