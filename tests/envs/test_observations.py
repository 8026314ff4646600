"""Observations: the true state seen from a robot's base, by its base frame."""

import mujoco
import numpy as np
import pytest
from arms import ALL, standing, swinging, with_puck

from airhockey import envs


def seen_from(frame, world):
    """A point of the world in a robot's frame."""
    return (np.linalg.inv(frame) @ np.append(world, 1.0))[:3]


@ALL
def test_every_player_sees_the_state_from_its_base(name):
    env = envs.make(name)
    info, robot = env.env_info, env.env_info["robot"]
    n = robot["n_joints"]
    prefix = "planar_robot" if n == 3 else "iiwa"
    env.reset(state=with_puck(env, -0.3, 0.2, 0.4, 0.5, -0.7, 3.0))
    for action in swinging(env, 12):
        rows = env.step(action)[0].reshape(env.n_players, -1)
        data = env.simulation.data
        for number, row in enumerate(rows, start=1):
            frame = robot["base_frame"][number - 1]
            x, y, yaw = data.qpos[-3:]
            np.testing.assert_allclose(row[info["puck_pos_ids"][:2]], seen_from(frame, [x, y, 0.0])[:2], atol=1e-12)
            turn = frame[:2, :2].T @ [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
            np.testing.assert_allclose([np.cos(row[2]), np.sin(row[2])], turn[:, 0], atol=1e-12)
            velocity = frame[:2, :2].T @ data.qvel[-3:-1]
            np.testing.assert_allclose(row[info["puck_vel_ids"]], [*velocity, data.qvel[-1]], atol=1e-12)
            joints = [data.joint(f"{prefix}_{number}/joint_{k + 1}").qpos[0] for k in range(n)]
            np.testing.assert_array_equal(row[info["joint_pos_ids"]], joints)
            if info["opponent_ee_ids"]:
                tip = data.body(f"iiwa_{3 - number}/striker_joint_link").xpos
                np.testing.assert_allclose(row[info["opponent_ee_ids"]], seen_from(frame, tip), atol=1e-12)


def test_the_opponents_tip_is_one_substep_old():
    env = envs.make("7dof-hit")
    env.reset(seed=0)
    for action in swinging(env, 20):
        observation = env.step(action)[0]
    model, data = env.simulation.model, env.simulation.data
    now, earlier = mujoco.MjData(model), mujoco.MjData(model)
    now.qpos[:] = data.qpos
    mujoco.mj_kinematics(model, now)
    earlier.qpos[:] = data.qpos - 0.001 * data.qvel  # the Euler integrator's last step, undone
    mujoco.mj_kinematics(model, earlier)
    frame = env.env_info["robot"]["base_frame"][0]
    tips = [seen_from(frame, d.body("iiwa_2/striker_joint_link").xpos) for d in (now, earlier)]
    np.testing.assert_allclose(observation[20:23], tips[1], atol=1e-12)
    assert np.abs(tips[0] - tips[1]).max() > 1e-5


@pytest.mark.parametrize(
    ("yaw", "wrapped"), [(0.5, 0.5), (4.0, 4.0 - 2 * np.pi), (-3.5, 2 * np.pi - 3.5), (20.0, None)]
)
def test_yaw_is_wrapped(yaw, wrapped):
    env = envs.make("7dof-prepare")
    observation = env.reset(state=with_puck(env, -0.5, 0.3, yaw, 0.0, 0.0, 0.0))
    assert -np.pi <= observation[2] < np.pi
    expected = (yaw + np.pi) % (2 * np.pi) - np.pi if wrapped is None else wrapped
    assert observation[2] == pytest.approx(expected, abs=1e-12)


def test_player_two_sees_yaw_zero_as_plus_pi():
    env = envs.make("tournament")
    rows = env.reset(state=with_puck(env, -0.5, 0.3, 0.0, 0.0, 0.0, 0.0)).reshape(2, -1)
    assert rows[0, 2] == 0.0 and rows[1, 2] == np.pi
    np.testing.assert_allclose(rows[:, :2], [[1.01, 0.3], [2.01, -0.3]], atol=1e-12)


def test_both_players_of_a_symmetric_scene_see_the_same():
    env = envs.make("tournament")
    rows = env.reset(state=with_puck(env, 0.0, 0.0, np.pi / 2, 0.0, 0.0, 0.0)).reshape(2, -1)
    np.testing.assert_allclose(np.delete(rows[0], 2), np.delete(rows[1], 2), atol=1e-12)
    assert rows[0, 2] == pytest.approx(-rows[1, 2])


def test_joint_velocities_are_filtered():
    """A closed form for one control step of constant velocity is in test_controller; here: they lag behind the true ones."""
    env = envs.make("7dof-prepare")
    env.reset(seed=0)
    for action in swinging(env, 5):
        observation = env.step(action)[0]
    true = env.simulation.data.qvel[:7]
    filtered = observation[13:20]
    assert np.abs(filtered - true).max() > 1e-4
    np.testing.assert_allclose(filtered, true, atol=0.1)


@ALL
def test_the_reset_observation_is_the_state_that_was_asked_for(name):
    env = envs.make(name)
    env.reset(seed=2)
    for action in swinging(env, 10):
        env.step(action)
    state, told = env.base_observation, env.true_observation
    observation = env.reset(state=state)
    n = env.env_info["robot"]["n_joints"]
    for before, after in zip(told.reshape(env.n_players, -1), observation.reshape(env.n_players, -1), strict=True):
        np.testing.assert_allclose(after[: 6 + 2 * n], before[: 6 + 2 * n], atol=1e-12)
    env.step(standing(env))
