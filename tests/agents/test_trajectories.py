"""Cartesian trajectories by end conditions and finite differences; joint trajectories by where they lead the rod tip."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from airhockey.agents.control.cartesian import BezierTrajectory, CompositeTrajectory, bezier, cubic, quintic
from airhockey.agents.control.joint_controller import JointController, JointState
from airhockey.agents.control.joint_trajectory import _smoothed, plan_joints
from airhockey.agents.control.kinematics import ArmKinematics
from airhockey.agents.control.workspace import Workspace
from airhockey.envs.specs import IIWA

A, B = np.array([0.7, 0.0]), np.array([0.95, 0.2])
VA, VB = np.array([0.3, -0.2]), np.array([0.5, 0.4])


def controller():
    return JointController(ArmKinematics(IIWA), Workspace.of({"robot": {"n_joints": 7}, "dt": 0.02}))


def assert_velocity_is_the_derivative(trajectory):
    for t in np.linspace(0.01, trajectory.duration - 0.01, 7):
        slope = (trajectory.at(t + 1e-6)[0] - trajectory.at(t - 1e-6)[0]) / 2e-6
        np.testing.assert_allclose(trajectory.at(t)[1], slope, atol=1e-6)


def test_a_cubic_meets_its_ends():
    path = cubic(A, VA, B, VB, 0.6)
    for time, position, velocity in ((0.0, A, VA), (0.6, B, VB), (-1.0, A, VA), (9.0, B, VB)):
        np.testing.assert_allclose(path.at(time)[0], position)
        np.testing.assert_allclose(path.at(time)[1], velocity)
    assert_velocity_is_the_derivative(path)


def test_a_quintic_meets_its_ends_with_its_accelerations():
    start, end = (A, VA, np.array([1.0, 2.0])), (B, VB, np.array([-1.0, 0.5]))
    path = quintic(start, end, 0.5)
    for time, (position, velocity, acceleration) in ((0.0, start), (0.5, end)):
        np.testing.assert_allclose(path.at(time)[0], position)
        np.testing.assert_allclose(path.at(time)[1], velocity, atol=1e-12)
        k = np.arange(2, 6)
        second = (k * (k - 1) * time ** (k - 2)) @ path.coefficients[2:]
        np.testing.assert_allclose(second, acceleration, atol=1e-9)
    assert_velocity_is_the_derivative(path)


def test_a_bezier_starts_and_ends_along_its_control_polygon_with_its_speeds():
    points = np.array([[0.0, 0.0], [0.1, 0.3], [0.4, 0.3], [0.5, 0.0]])
    path = BezierTrajectory(points, 0.7, 0.2, 1.1)
    for time, position, direction, speed in ((0.0, points[0], points[1] - points[0], 0.2),
                                             (0.7, points[3], points[3] - points[2], 1.1)):  # fmt: skip
        np.testing.assert_allclose(path.at(time)[0], position, atol=1e-12)
        np.testing.assert_allclose(path.at(time)[1], speed * direction / np.linalg.norm(direction), atol=1e-9)
    assert_velocity_is_the_derivative(path)


def test_a_bezier_is_de_casteljaus():
    points = np.random.default_rng(1).normal(size=(5, 2))
    for s in (0.0, 0.3, 0.8, 1.0):
        level = points
        while len(level) > 1:
            level = (1 - s) * level[:-1] + s * level[1:]
        np.testing.assert_allclose(bezier(points, s)[0], level[0], atol=1e-12)


def test_pieces_follow_one_another():
    path = CompositeTrajectory((cubic(A, VA, B, VB, 0.3), cubic(B, VB, A, VA, 0.4)))
    assert path.duration == pytest.approx(0.7)
    np.testing.assert_allclose(path.at(0.3)[0], B)
    np.testing.assert_allclose(path.at(0.7)[0], A, atol=1e-12)
    np.testing.assert_allclose(path.at(0.1)[0], path.pieces[0].at(0.1)[0])


def test_the_smoothing_is_scipys_spline():
    rng = np.random.default_rng(2)
    start = JointState(np.concatenate([rng.normal(size=6), np.zeros(4)]))
    positions = start.position + np.cumsum(0.02 * rng.normal(size=(9, 3)), axis=0)
    ends = ((1, start.velocity), (2, np.zeros(3)))
    spline = CubicSpline(0.02 * np.arange(10), np.vstack([start.position, positions]), bc_type=ends)
    np.testing.assert_allclose(_smoothed(start, positions, 0.02)[1], spline(0.02 * np.arange(1, 10), 1), atol=1e-9)


@pytest.mark.parametrize("smooth", [False, True])
def test_joint_commands_lead_the_tip_along_the_trajectory(smooth):
    control = controller()
    path = cubic(control.tip_position(), np.zeros(2), np.array([0.8, 0.1]), np.array([0.3, 0.0]), 0.6)
    plan = plan_joints(control, lambda stretch: path, smooth=smooth)
    assert plan.stretch == 1.0 and len(plan) == 30
    for k in range(len(plan)):
        tip = control.kinematics.position(plan.positions[k])
        np.testing.assert_allclose(tip[:2], path.at(0.02 * (k + 1))[0], atol=2e-3)
        assert tip[2] == pytest.approx(IIWA.desired_height, abs=1e-3)
        assert np.all(np.abs(plan.velocities[k]) <= 0.95 * IIWA.joint_velocity_limit[1])
    np.testing.assert_allclose(control.state.position, IIWA.start)  # planning has not moved anything
    np.testing.assert_allclose(plan.state(control.kinematics, 99).position, plan.positions[-1])


def test_a_trajectory_that_is_too_fast_is_slowed_down_and_one_never_possible_is_refused():
    control = controller()
    start, end = control.tip_position(), np.array([1.1, 0.0])

    def make(stretch):
        return cubic(start, np.zeros(2), end, np.zeros(2), 0.4 * stretch)

    plan = plan_joints(control, make, budget=1000)
    assert plan is not None and plan.stretch > 1.0
    np.testing.assert_allclose(control.kinematics.position(plan.positions[-1])[:2], end, atol=2e-3)
    assert plan_joints(control, lambda stretch: make(0.05)) is None
    assert plan_joints(control, make, budget=5) is None
