"""Kinematics and Jacobian against MuJoCo and finite differences; what inverse kinematics solves and when it gives up."""

import mujoco
import numpy as np
import pytest
from arms import ROBOTS, alone, differences, random_joints

from airhockey.envs.kernel.kinematics import (
    damped_solve,
    forward_kinematics,
    inverse_kinematics,
    point_jacobian,
    work_space,
)


def forward(arm, position):
    n = position.size
    positions, axes = np.empty((n + 1, 3)), np.empty((n + 2, 3))
    forward_kinematics(arm, np.ascontiguousarray(position), positions, axes)
    return positions, axes


def tip(arm, position):
    return forward(arm, position)[0][-1]


@ROBOTS
def test_positions_and_axes_are_mujocos(robot):
    model, data, arm = alone(robot)
    names = [f"{robot.prefix}_1/{robot.link_prefix}_{k + 1}" for k in range(robot.n_joints)]
    end = data.body(f"{robot.prefix}_1/{robot.end_effector}")
    for position, _, _ in random_joints(robot, 3):
        data.qpos[:] = position
        mujoco.mj_forward(model, data)
        positions, axes = forward(arm, position)
        expected = [data.body(name).xpos for name in names] + [end.xpos]
        np.testing.assert_allclose(positions, expected, atol=1e-12)
        np.testing.assert_allclose(axes[:-2], data.xaxis, atol=1e-12)
        np.testing.assert_allclose(axes[-2:], end.xmat.reshape(3, 3)[:, :2].T, atol=1e-12)


@ROBOTS
@pytest.mark.parametrize("point", [-1, 0, 2])
def test_jacobian_is_mujocos_and_the_derivative_of_the_position(robot, point):
    model, data, arm = alone(robot)
    n = robot.n_joints
    index = n if point == -1 else point
    name = robot.end_effector if point == -1 else f"{robot.link_prefix}_{index + 1}"
    body = model.body(f"{robot.prefix}_1/{name}").id
    for position, _, _ in random_joints(robot, 4, 8):
        positions, axes = forward(arm, position)
        jacobian = np.empty((3, n))
        point_jacobian(positions, axes, index, jacobian)
        data.qpos[:] = position
        mujoco.mj_forward(model, data)
        expected = np.zeros((3, n))
        mujoco.mj_jacBody(model, data, expected, None, body)
        np.testing.assert_allclose(jacobian, expected, atol=1e-12)
        derivative = differences(lambda q: forward(arm, q)[0][index], position)
        np.testing.assert_allclose(jacobian, derivative, atol=1e-8)


def test_the_damped_solution_minimises_the_damped_error():
    random = np.random.default_rng(5)
    for n in (3, 7):
        jacobian, error, step = random.normal(size=(3, n)), random.normal(size=3), np.empty(n)
        damped_solve(jacobian, error, 1e-3, step)
        normal = jacobian.T @ jacobian + 1e-3 * np.eye(n)
        np.testing.assert_allclose(normal @ step, jacobian.T @ error, atol=1e-12)


@ROBOTS
def test_inverse_kinematics_solves_for_what_is_in_reach(robot):
    _, _, arm = alone(robot)
    random = np.random.default_rng(6)
    for _ in range(20):
        target = np.array([random.uniform(0.65, 1.2), random.uniform(-0.4, 0.4), robot.desired_height])
        joints = np.array(robot.start)
        assert inverse_kinematics(arm, target, joints, work_space(robot.n_joints))
        assert np.linalg.norm(tip(arm, joints) - target) < 1e-4
        assert np.all(np.abs(joints) <= 0.95 * robot.joint_position_limit[1])


@ROBOTS
@pytest.mark.parametrize("target", [(2.5, 0.0, 0.15), (0.0, -4.0, 0.15)])
def test_inverse_kinematics_gives_up_within_the_limits(robot, target):
    _, _, arm = alone(robot)
    joints = np.array(robot.start)
    assert not inverse_kinematics(arm, np.array(target), joints, work_space(robot.n_joints))
    assert np.all(np.abs(joints) <= 0.95 * robot.joint_position_limit[1])


def slow_inverse_kinematics(arm, target, joints):
    """The challenge's section 4, with NumPy."""
    low, high = 0.95 * arm.position_limit
    for _ in range(1000):
        positions, axes = forward(arm, joints)
        error = target - positions[-1]
        if np.linalg.norm(error) < 1e-4:
            return True, joints
        jacobian = np.cross(axes[:-2], positions[-1] - positions[:-1]).T
        step = np.linalg.solve(jacobian.T @ jacobian + 1e-3 * np.eye(joints.size), jacobian.T @ error)
        if np.linalg.norm(error) / np.linalg.norm(step) > 20.0:
            return False, joints
        joints = np.clip(joints + step * min(1.0, 0.1 / np.linalg.norm(step)), low, high)
    return False, joints


@ROBOTS
def test_inverse_kinematics_takes_the_described_steps_and_ends_where_it_should(robot):
    _, _, arm = alone(robot)
    random = np.random.default_rng(7)
    ends = set()
    for _ in range(12):
        distance, angle = random.uniform(0.5, 1.8), random.uniform(-0.8, 0.8)
        target = np.array([distance * np.cos(angle), distance * np.sin(angle), robot.desired_height])
        joints = np.array(robot.start)
        solved = inverse_kinematics(arm, target, joints, work_space(robot.n_joints))
        expected = slow_inverse_kinematics(arm, target, np.array(robot.start))
        assert solved == expected[0]
        np.testing.assert_allclose(joints, expected[1], atol=1e-6)
        ends.add(solved)
    assert ends == {True, False}


@ROBOTS
def test_inverse_kinematics_stays_where_the_tip_is_already(robot):
    _, _, arm = alone(robot)
    joints = np.array(robot.start)
    assert inverse_kinematics(arm, tip(arm, joints) + 5e-5, joints, work_space(robot.n_joints))
    np.testing.assert_array_equal(joints, robot.start)


@ROBOTS
def test_the_start_is_the_home_position(robot):
    _, _, arm = alone(robot)
    np.testing.assert_allclose(tip(arm, np.array(robot.start)), [0.65, 0.0, robot.desired_height], atol=1e-4)
