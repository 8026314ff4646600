"""Safety limiter, feed-forward PD torque and velocity filter, each against its definition."""

import mujoco
import numpy as np
import pytest
from arms import ROBOTS, alone, random_joints
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from airhockey.envs.kernel.controller import add_feedback, filter_velocity, limit_set_point, new_controller
from airhockey.envs.kernel.dynamics import inverse_dynamics
from airhockey.envs.kernel.kinematics import link_rotations
from airhockey.envs.specs import IIWA

GAINS = {  # challenge page, section 2
    "planar_robot": ([960, 480, 240], [60, 20, 4]),
    "iiwa": ([1500, 1500, 1200, 1200, 1000, 1000, 500], [60, 80, 60, 30, 10, 1, 0.5]),
}


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    share=arrays(float, 7, elements=st.floats(-1.0, 1.0)),
    wishes=arrays(float, (25, 3, 7), elements=st.floats(-1e9, 1e9) | st.floats(-4.0, 4.0)),
)
def test_no_wish_leads_over_the_limits(share, wishes):
    _, _, arm = alone(IIWA)
    clipped = share * arm.position_limit[1]
    for wish in wishes:
        before, acceleration = clipped.copy(), wish[2].copy()
        limit_set_point(arm, wish, clipped)
        np.testing.assert_array_equal(clipped, wish[0])
        np.testing.assert_array_equal(wish[2], acceleration)
        assert np.all(clipped >= arm.position_limit[0] - 1e-12) and np.all(clipped <= arm.position_limit[1] + 1e-12)
        # within the velocity limits, and slower the nearer the position limit is
        fastest = np.clip(20.0 * (arm.position_limit[1] - before), *arm.velocity_limit)
        slowest = np.clip(20.0 * (arm.position_limit[0] - before), *arm.velocity_limit)
        for velocity in (wish[1], (clipped - before) / 0.001):
            assert np.all(velocity <= fastest + 1e-9) and np.all(velocity >= slowest - 1e-9)


def test_a_wish_within_the_limits_passes_unchanged():
    _, _, arm = alone(IIWA)
    clipped = np.zeros(7)
    wish = np.array([np.full(7, 5e-4), np.full(7, 0.5), np.full(7, 3.0)])
    limited = wish.copy()
    limit_set_point(arm, limited, clipped)
    np.testing.assert_array_equal(limited, wish)


def test_towards_a_limit_the_distance_decays_exponentially():
    _, _, arm = alone(IIWA)
    clipped = 0.99 * arm.position_limit[1]
    gaps = []
    for _ in range(100):
        limit_set_point(arm, np.full((3, 7), 1e3), clipped)
        gaps.append(arm.position_limit[1] - clipped)
    np.testing.assert_allclose(gaps[-1], 0.01 * arm.position_limit[1] * (1.0 - 20.0 * 0.001) ** 100, rtol=1e-9)


@ROBOTS
def test_the_torque_is_proportional_derivative_and_feed_forward(robot):
    model, data, arm = alone(robot)
    stiffness, viscosity = (np.array(gains) for gains in GAINS[robot.prefix])
    n = robot.n_joints
    set_points = [np.stack(joints) for joints in random_joints(robot, 12)]
    for set_point, (position, velocity, _) in zip(set_points, random_joints(robot, 13), strict=True):
        controller = new_controller(1, n)
        link_rotations(arm, position, controller.rotations)
        torque = controller.torque
        inverse_dynamics(arm, controller.rotations, velocity, set_point[2], controller.forces, torque)
        add_feedback(arm, set_point, position, velocity, torque)
        data.qpos[:], data.qvel[:] = position, velocity
        mujoco.mj_forward(model, data)
        mass = np.zeros((n, n))
        mujoco.mj_fullM(model, data, mass)
        expected = stiffness * (set_point[0] - position) + viscosity * (set_point[1] - velocity)
        np.testing.assert_allclose(torque, expected + mass @ set_point[2] + data.qfrc_bias, rtol=1e-10, atol=1e-9)


def test_the_filter_approaches_a_constant_velocity_geometrically():
    measured, filtered = np.array([9.0, 1.0, -2.0, 9.0]), np.array([3.0, 0.5])
    for k in range(1, 31):
        filter_velocity(measured, 1, filtered)
        remaining = 0.726**k
        expected = np.array([1.0, -2.0]) * (1.0 - remaining) + np.array([3.0, 0.5]) * remaining
        np.testing.assert_allclose(filtered, expected, rtol=1e-12)


def test_the_filter_leaves_a_velocity_that_it_has_reached():
    filtered = np.array([0.7])
    filter_velocity(np.array([0.7]), 0, filtered)
    assert filtered[0] == pytest.approx(0.7, rel=1e-15)
