"""The universal joint: its formulas, its geometry where they are exact, and a mallet that stays level."""

import mujoco
import numpy as np
import pytest
from arms import alone, random_joints, striker_angles, swinging

from airhockey import envs
from airhockey.envs.kernel.kinematics import link_rotations
from airhockey.envs.kernel.universal_joint import clip_angle, desired_angles, rod_axes, striker_torque, unwrap
from airhockey.envs.specs import IIWA


def axes_of_rod(arm, position):
    rotations, axes = np.empty((7, 3, 3)), np.empty((2, 3))
    link_rotations(arm, position, rotations)
    rod_axes(rotations, axes)
    return axes


def test_the_rods_axes_are_mujocos():
    model, data, arm = alone(IIWA)
    for position, _, _ in random_joints(IIWA, 20):
        data.qpos[:] = position
        mujoco.mj_forward(model, data)
        matrix = data.body("iiwa_1/striker_joint_link").xmat.reshape(3, 3)
        np.testing.assert_allclose(axes_of_rod(arm, position), matrix[:, :2].T, atol=1e-12)


def test_the_angles_are_those_of_the_challenge():
    _, _, arm = alone(IIWA)
    for position, _, _ in random_joints(IIWA, 21, 100):
        axes = axes_of_rod(arm, position)
        np.testing.assert_allclose(desired_angles(axes), striker_angles(*axes), atol=1e-9)


def test_the_first_angle_turns_the_rods_x_axis_horizontal():
    _, _, arm = alone(IIWA)
    for position, _, _ in random_joints(IIWA, 22, 50):
        x, y = axes = axes_of_rod(arm, position)
        angle, _ = desired_angles(axes)
        turned = x * np.cos(angle) + np.cross(y, x) * np.sin(angle)  # Rodrigues; x is normal to y
        assert turned[2] == pytest.approx(0.0, abs=1e-12)


def test_a_small_first_angle_leaves_the_mallet_level():
    """Both hinges together; the official slip in the second step is of the order of the first angle squared."""
    turn = mujoco.mju_axisAngle2Quat
    for first in (-1e-4, 0.0, 1e-4):
        for second in (-0.8, 0.0, 0.5):
            quaternion, matrix, about_x, about_y = np.zeros(4), np.zeros(9), np.zeros(4), np.zeros(4)
            turn(about_x, np.array([1.0, 0, 0]), np.pi - second)  # the rod hangs down, tilted by both angles
            turn(about_y, np.array([0, 1.0, 0]), -first)
            mujoco.mju_mulQuat(quaternion, about_x, about_y)
            mujoco.mju_quat2Mat(matrix, quaternion)
            rod = matrix.reshape(3, 3)
            found = desired_angles(np.ascontiguousarray(rod[:, :2].T))
            np.testing.assert_allclose(found, [first, second], atol=1e-7)


@pytest.mark.parametrize(("angle", "reference"), [(3.0, -3.0), (-3.0, 3.0), (0.5, 0.4), (3.0, 0.0), (-1.0, 2.0)])
def test_unwrapping_moves_by_a_full_turn_to_the_nearest(angle, reference):
    candidates = angle + 2.0 * np.pi * np.array([-1.0, 0.0, 1.0])
    assert unwrap(angle, reference) == pytest.approx(candidates[np.abs(candidates - reference).argmin()])


def test_angles_are_clipped_to_95_percent_of_a_right_angle():
    soft = 0.95 * np.pi / 2
    assert [clip_angle(angle) for angle in (-3.0, -0.2, 1.4, 1.6)] == [-soft, -0.2, 1.4, soft]


def test_the_torque_is_a_spring_with_a_filtered_damper():
    average, expected = np.zeros(2), 0.0
    for velocity in (1.0, 2.0, -3.0):
        expected = 0.273 * velocity + 0.727 * expected
        assert striker_torque(0.3, 0.1, velocity, average, 1) == pytest.approx(4.0 * 0.2 - 0.31 * expected)
    assert average[0] == 0.0


def test_the_mallet_stays_level_under_a_tilted_moving_rod():
    env = envs.make("7dof-prepare")
    env.reset(seed=0)

    def tilt(body):
        upright = env.simulation.data.body(f"iiwa_1/{body}").xmat.reshape(3, 3)[2, 2]
        return np.degrees(np.arccos(min(1.0, abs(upright))))

    for action in swinging(env, 150):
        env.step(action)
        assert tilt("striker_joint_link") > 15.0 and tilt("striker_mallet") < 8.0
    for _ in range(50):  # it settles where the arm stops
        env.step(action * [[1.0], [0.0]])
    assert tilt("striker_joint_link") > 15.0 and tilt("striker_mallet") < 1.0
