"""Constraint values by hand and by MuJoCo's kinematics, their Jacobians by finite differences."""

import mujoco
import numpy as np
from arms import ALL, ROBOTS, alone, differences, random_joints, standing, swinging

from airhockey import envs
from airhockey.envs.specs import IIWA, PLANAR

NAMES = ["joint_pos_constr", "joint_vel_constr", "ee_constr", "link_constr"]
HEIGHT = {"planar_robot": 0.1, "iiwa": 0.1645}


def constraints_of(robot):
    return envs.make("3dof-hit" if robot is PLANAR else "7dof-hit").env_info["constraints"]


def by_mujoco(robot, position):
    """End-effector position, wrist and elbow height in the robot frame."""
    model, data, _ = alone(robot)
    data.qpos[:] = position
    mujoco.mj_forward(model, data)
    tip = data.body(f"{robot.prefix}_1/{robot.end_effector}").xpos.copy()
    heights = [data.body(f"iiwa_1/link_{k}").xpos[2] for k in (7, 4)] if robot is IIWA else []
    return tip, np.array(heights)


@ROBOTS
def test_names_and_dimensions(robot):
    constraints = constraints_of(robot)
    n = robot.n_joints
    expected = dict(zip(NAMES, (2 * n, 2 * n, 5, 2), strict=True))
    if robot is PLANAR:
        del expected["link_constr"]
    assert list(constraints.keys()) == list(constraints) == list(expected)
    values = constraints.fun(np.zeros(n), np.zeros(n))
    jacobians = constraints.jacobian(np.zeros(n), np.zeros(n))
    for name, dim in expected.items():
        constraint = constraints.get(name)
        assert (constraint.name, constraint.output_dim) == (name, dim)
        assert values[name].shape == constraint.fun(np.zeros(n), np.zeros(n)).shape == (dim,)
        assert jacobians[name].shape == constraint.jacobian(np.zeros(n), np.zeros(n)).shape == (dim, 2 * n)


@ROBOTS
def test_values_are_those_of_the_rules(robot):
    constraints = constraints_of(robot)
    h = HEIGHT[robot.prefix]
    x_lb, y_b = 1.51 - (0.974 - 0.04815), 0.519 - 0.04815
    for q, dq, _ in random_joints(robot, 30):
        values = constraints.fun(q, 1.2 * dq)
        low, high = 0.95 * robot.joint_position_limit
        np.testing.assert_allclose(values["joint_pos_constr"], np.r_[q - high, low - q], atol=1e-15)
        low, high = 0.95 * robot.joint_velocity_limit
        np.testing.assert_allclose(values["joint_vel_constr"], np.r_[1.2 * dq - high, low - 1.2 * dq], atol=1e-15)
        (x, y, z), heights = by_mujoco(robot, q)
        expected = [x_lb - x, -y_b - y, y - y_b, (h - 0.02) - z, z - (h + 0.02)]
        np.testing.assert_allclose(values["ee_constr"], expected, atol=1e-12)
        if robot is IIWA:
            np.testing.assert_allclose(values["link_constr"], 0.25 - heights, atol=1e-12)


@ROBOTS
def test_jacobians_are_the_derivatives(robot):
    constraints = constraints_of(robot)
    n = robot.n_joints
    for q, dq, _ in random_joints(robot, 31, 5):
        jacobians = constraints.jacobian(q, dq)
        for name in constraints.keys():  # noqa: SIM118
            derivative = differences(lambda v, name=name: constraints.get(name).fun(v[:n], v[n:]), np.r_[q, dq])
            np.testing.assert_allclose(jacobians[name], derivative, atol=1e-7)


@ROBOTS
def test_lists_and_columns_of_joints_are_understood(robot):
    constraints = constraints_of(robot)
    q = np.array(robot.start)
    expected = constraints.get("ee_constr").fun(q, 0 * q)
    for other in (robot.start, list(robot.start), q[:, None], np.stack([q, q], axis=1)[:, 0]):
        np.testing.assert_array_equal(constraints.get("ee_constr").fun(other, 0 * q), expected)


@ALL
def test_a_step_reports_what_the_functions_say_of_the_true_joints(name):
    env = envs.make(name, disturbances="harsh")
    env.reset(seed=4)
    n = env.env_info["robot"]["n_joints"]
    constraints = env.env_info["constraints"]
    for action in swinging(env, 10):
        info = env.step(action)[3]
        players = info["constraints_value"] if env.n_players == 2 else [info["constraints_value"]]
        truths = env.true_observation.reshape(env.n_players, -1)
        flats = env.constraint_values.reshape(env.n_players, -1)
        for values, truth, flat in zip(players, truths, flats, strict=True):
            expected = constraints.fun(truth[6 : 6 + n], truth[6 + n : 6 + 2 * n])
            assert list(values) == list(expected)
            for key, value in expected.items():
                np.testing.assert_array_equal(values[key], value)
                np.testing.assert_array_equal(flat[env.constraint_slices[key]], value)


@ALL
def test_nobody_violates_a_constraint_at_rest(name):
    env = envs.make(name)
    env.reset(seed=0)
    for _ in range(25):
        env.step(standing(env))
        assert np.all(env.constraint_values <= 0.0)
