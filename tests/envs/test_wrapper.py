"""`AirHockeyChallengeWrapper`: the official interface, as agents and MushroomRL use it."""

import subprocess
import sys

import mujoco
import numpy as np
import pytest
from arms import ALL, standing, swinging
from tools import needs_opencv, needs_rendering

from airhockey import envs


@pytest.fixture(autouse=True)
def opencv() -> None:
    needs_opencv()


@pytest.fixture(autouse=True)
def global_random():
    """The wrapper draws from NumPy's global generator, as the official one does; put it back."""
    before = np.random.get_state()
    yield
    np.random.set_state(before)


@ALL
def test_it_is_a_mushroom_environment_with_its_spaces(name):
    from mushroom_rl.core import Environment, MDPInfo
    from mushroom_rl.utils.spaces import Box

    env = envs.AirHockeyChallengeWrapper(name)
    assert isinstance(env, Environment)
    info = env.info
    assert isinstance(info, MDPInfo) and env.env_info["rl_info"] is info
    assert isinstance(info.observation_space, Box) and isinstance(info.action_space, Box)
    n = env.env_info["robot"]["n_joints"]
    assert info.observation_space.shape == (6 + 2 * n + (3 if env.env_info["n_agents"] == 2 else 0),)
    assert info.action_space.shape == (n * env.env_info["n_agents"],)
    assert (info.gamma, info.horizon) == (0.99, 45_000 if name == "tournament" else 500)
    assert env.env_name == name


@ALL
def test_a_global_seed_gives_the_episode_of_the_environments_seed(name):
    """So that a run of the official evaluation starts where the official one would."""
    plain = envs.make(name)
    np.random.seed(21)
    wrapped = envs.AirHockeyChallengeWrapper(name)
    for seed in (21, None):
        np.testing.assert_array_equal(wrapped.reset(), plain.reset(seed=seed))
        for action in swinging(plain, 5):
            for ours, theirs in zip(plain.step(action)[:3], wrapped.step(action)[:3], strict=True):
                np.testing.assert_array_equal(ours, theirs)


def test_the_base_environment_shows_mujocos_model_and_data():
    env = envs.AirHockeyChallengeWrapper("7dof-hit")
    base = env.base_env
    assert isinstance(base.model, mujoco.MjModel) and isinstance(base.data, mujoco.MjData)
    assert base._model is base.model and base._data is base.data
    assert base.env_info is env.env_info and base.info is env.info and base.dt == 0.02
    np.testing.assert_allclose(base.init_state, [0, -0.1960673452, 0, -1.8436389809, 0, 0.9704222379, 0], atol=1e-10)
    env.reset()
    base.data.joint("puck_y").qpos[0] = 0.123
    assert env.step(standing(env._env))[0][1] == pytest.approx(0.123, abs=0.01)


@pytest.mark.parametrize("name", ["7dof-hit", "tournament"])
def test_a_custom_reward_sees_the_step_in_world_coordinates(name):
    seen = []

    def reward(base_env, state, action, next_state, absorbing):
        seen.append((base_env, state, action, next_state, absorbing))
        return -1.5

    env = envs.AirHockeyChallengeWrapper(name, reward)
    env.reset()
    before = env._env.base_observation
    action = standing(env._env)
    _, value, absorbing, _ = env.step(action)
    assert value == -1.5
    [(base, state, given, after, over)] = seen
    assert base is env.base_env and given is action and over == absorbing
    np.testing.assert_array_equal(state, before)
    np.testing.assert_array_equal(after, env._env.base_observation)
    assert state.shape == (46,)
    data = env.base_env.data
    np.testing.assert_allclose(base.get_puck(after)[0][:2], data.qpos[-3:-1])
    np.testing.assert_array_equal(base.get_joints(after)[0], data.qpos[:7])
    np.testing.assert_array_equal(base.get_joints(after, 2)[0], data.qpos[9:16])
    assert base.is_absorbing(after) == absorbing


def test_is_absorbing_is_false_after_a_reset():
    env = envs.AirHockeyChallengeWrapper("7dof-prepare")
    assert not env.base_env.is_absorbing(env.reset())
    state = env._env.base_observation
    state[:6] = [-0.5, 0.001, 0, 0, 0, 0]
    env.reset(state)
    observation, _, absorbing, _ = env.step(standing(env._env))
    assert absorbing and env.base_env.is_absorbing(observation)
    assert not env.base_env.is_absorbing(env.reset())


def test_the_tournament_reports_pairs():
    env = envs.AirHockeyChallengeWrapper("tournament", interpolation_order=[3, 1])
    env.reset()
    action = standing(env._env)
    observation, reward, _, info = env.step((action[0], action[1][0]))
    assert observation.shape == (46,) and reward == 0.0
    assert [sorted(values) for values in info["constraints_value"]] == [
        ["ee_constr", "joint_pos_constr", "joint_vel_constr", "link_constr"]
    ] * 2
    assert info["score"] == info["faults"] == [0, 0]
    env.stop()


def test_seeding_decides_starts_and_disturbances():
    told = []
    for _ in range(2):
        env = envs.AirHockeyChallengeWrapper("7dof-prepare", disturbances="harsh")
        env.reset()
        env.seed(5)
        told.append([env.reset().tobytes(), env.step(standing(env._env))[0].tobytes()])
    assert told[0] == told[1]


def test_nothing_heavy_is_imported_before_it_is_used_and_a_missing_mushroom_is_explained():
    program = """
import sys
from airhockey import envs
heavy = {"mujoco", "numba", "mushroom_rl", "torch"}
print(sorted(heavy & set(sys.modules)))
envs.make("3dof-hit").reset()
print(sorted({"mushroom_rl", "torch"} & set(sys.modules)))
sys.modules["mushroom_rl.core"] = None
try:
    envs.AirHockeyChallengeWrapper
except ImportError as error:
    print(type(error).__name__, error)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    before, after, missing = done.stdout.splitlines()
    assert before == after == "[]"
    assert missing.startswith("MissingDependencyError") and "pip install 'airhockey[mushroom]'" in missing


def test_it_renders() -> None:
    needs_rendering()
    env = envs.AirHockeyChallengeWrapper("3dof-hit")
    env.reset()
    assert env.render(record=True).shape == (360, 640, 3)
    env.stop()
