"""`env_info`: every key of the challenge's section 7, with its type and value."""

from itertools import chain

import mujoco
import numpy as np
import pytest
from arms import ALL

from airhockey import envs
from airhockey.errors import ConfigurationError

KEYS = {
    "env_name", "n_agents", "dt", "puck_pos_ids", "puck_vel_ids", "joint_pos_ids", "joint_vel_ids", "opponent_ee_ids",
    "rl_info", "table", "puck", "mallet", "constraints", "robot",
}  # fmt: skip
ROBOT_KEYS = {
    "n_joints", "base_frame", "ee_desired_height", "joint_pos_limit", "joint_vel_limit",
    "joint_acc_limit", "control_frequency", "robot_model", "robot_data",
}  # fmt: skip


@ALL
def test_every_key_is_there(name):
    info = envs.make(name).env_info
    assert set(info) >= KEYS and set(info["robot"]) >= ROBOT_KEYS
    assert info["env_name"] == name
    assert info["n_agents"] == (2 if name in ("7dof-hit", "tournament") else 1)
    assert info["dt"] == 0.02 and info["robot"]["control_frequency"] == 50
    assert info["table"] == {"length": 1.948, "width": 1.038, "goal_width": 0.25}
    assert info["puck"] == {"radius": 0.03165} and info["mallet"] == {"radius": 0.04815}


@ALL
def test_the_indices_divide_an_observation(name):
    info = envs.make(name).env_info
    ids = [info[f"{part}_ids"] for part in ("puck_pos", "puck_vel", "joint_pos", "joint_vel", "opponent_ee")]
    n = info["robot"]["n_joints"]
    assert [len(part) for part in ids] == [3, 3, n, n, 3 if info["n_agents"] == 2 else 0]
    size = 6 + 2 * n + len(ids[-1])
    assert list(chain.from_iterable(ids)) == list(range(size))
    assert info["rl_info"].observation_space.shape == (size,)


@ALL
def test_the_robot_is_described(name):
    robot = envs.make(name).env_info["robot"]
    iiwa = not name.startswith("3dof")
    n = 7 if iiwa else 3
    assert robot["n_joints"] == n
    assert robot["ee_desired_height"] == (0.1645 if iiwa else 0.1)
    assert robot.get("universal_height") == (0.0645 if iiwa else None)
    velocity = np.radians([85, 85, 100, 75, 130, 135, 135]) if iiwa else np.pi * np.array([1 / 2, 1 / 2, 2 / 3])
    np.testing.assert_allclose(robot["joint_vel_limit"], [-velocity, velocity])
    factor = 10 if iiwa else 4
    np.testing.assert_allclose(robot["joint_acc_limit"], [-factor * velocity, factor * velocity])
    for key in ("joint_pos_limit", "joint_vel_limit", "joint_acc_limit"):
        assert robot[key].shape == (2, n) and robot[key].dtype == np.float64
    assert isinstance(robot["robot_model"], mujoco.MjModel) and isinstance(robot["robot_data"], mujoco.MjData)
    assert robot["robot_model"].nq == n


@ALL
def test_the_base_frames_lead_from_robot_to_world(name):
    info = envs.make(name).env_info
    frames = info["robot"]["base_frame"]
    assert len(frames) == info["n_agents"]
    for frame, side in zip(frames, (1.0, -1.0), strict=False):
        expected = np.diag([side, side, 1.0, 1.0])
        expected[:3, 3] = [-1.51 * side, 0.0, -0.1]
        np.testing.assert_allclose(frame, expected)


@ALL
def test_the_boxes_are_those_of_the_challenge(name):
    info = envs.make(name).env_info
    rl, robot = info["rl_info"], info["robot"]
    low = [0, -1, -np.pi, -20, -20, -100, *robot["joint_pos_limit"][0], *robot["joint_vel_limit"][0]]
    high = [3.02, 1, np.pi, 20, 20, 100, *robot["joint_pos_limit"][1], *robot["joint_vel_limit"][1]]
    if info["n_agents"] == 2:
        low += [1.5, -1.5, -1.5]
        high += [4.5, 1.5, 1.5]
    np.testing.assert_allclose(rl.observation_space.low, low)
    np.testing.assert_allclose(rl.observation_space.high, high)
    assert (rl.gamma, rl.horizon, rl.dt) == (0.99, 45_000 if name == "tournament" else 500, 0.02)


@pytest.mark.parametrize(
    ("order", "shape"), [(1, (7,)), (2, (7,)), (3, (2, 7)), (4, (2, 7)), (5, (3, 7)), (-1, (2, 7)), (None, (20, 3, 7))]
)
def test_an_action_has_the_shape_of_the_order_and_the_limits_of_the_robot(order, shape):
    env = envs.make("7dof-prepare", interpolation_order=order)
    robot = env.env_info["robot"]
    low, high = env.formats[0].limits(env.simulation.robot)
    assert env.formats[0].shape == low.shape == high.shape == shape
    limits = np.stack([robot[f"joint_{kind}_limit"][1] for kind in ("pos", "vel", "acc")])
    expected = np.tile(limits, (20, 1, 1)) if order is None else limits[: shape[0]] if len(shape) == 2 else limits[0]
    np.testing.assert_array_equal(high, expected)
    np.testing.assert_array_equal(low, -expected)


def test_an_agent_that_changes_its_information_harms_nobody_else():
    first, second = envs.make("7dof-prepare"), envs.make("7dof-prepare")
    first.env_info["robot"]["joint_pos_limit"][:] = 0.0
    first.env_info["robot"]["base_frame"][0][:] = 0.0
    assert np.all(second.env_info["robot"]["joint_pos_limit"][1] > 2.0)
    later = envs.make("7dof-prepare").env_info["robot"]
    assert np.all(later["joint_pos_limit"][1] > 2.0)
    assert later["base_frame"][0][0, 3] == -1.51
    assert np.all(first.constraint_values[:14] < 0.0)


@pytest.mark.parametrize("name", ["7dof-prepare", "tournament"])
@pytest.mark.parametrize("order", [0, 6, "3", 2.5, True, [3], (3, 3, 3), ()])
def test_an_order_that_does_not_exist_is_refused(name, order):
    with pytest.raises(ConfigurationError, match="interpolation order"):
        envs.make(name, interpolation_order=order)


def test_a_pair_of_orders_is_for_two_players():
    env = envs.make("tournament", interpolation_order=(1, 5))
    assert [form.shape for form in env.formats] == [(7,), (3, 7)]
    with pytest.raises(ConfigurationError, match="1 player"):
        envs.make("7dof-hit", interpolation_order=(3, 3))
    with pytest.raises(ConfigurationError, match="2 player"):
        envs.make("tournament", interpolation_order=(3,))


@pytest.mark.parametrize(("name", "near"), [("7dof-prepar", "7dof-prepare"), ("tournaments", "tournament")])
def test_an_unknown_environment_or_edition_names_the_nearest(name, near):
    with pytest.raises(ConfigurationError, match=f"Did you mean '{near}'"):
        envs.make(name)
    with pytest.raises(ConfigurationError, match="2023"):
        envs.make(near, edition="2032")
