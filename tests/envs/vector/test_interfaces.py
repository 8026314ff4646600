"""A batch under Gymnasium's and Stable-Baselines3's names."""

import subprocess
import sys
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from stable_baselines3 import PPO

import airhockey.envs.gymnasium  # noqa: F401 - registers the ids
from airhockey.envs.vector.stable_baselines3 import BatchVecEnv
from airhockey.errors import ConfigurationError

ID = "airhockey/3dof-hit-v0"


def random_actions(vec, steps, seed=0):
    random = np.random.default_rng(seed)
    start = np.array(vec.unwrapped.batch.single.simulation.robot.start)
    for _ in range(steps):
        yield np.stack(
            [start + random.uniform(-0.3, 0.3, (vec.num_envs, 3)), random.uniform(-1, 1, (vec.num_envs, 3))], 1
        )


def test_it_is_gymnasiums_own_batch_of_the_same_environments():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        vec = gymnasium.make_vec(ID, num_envs=3, threads=2)
    assert vec.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP
    assert vec.spec.max_episode_steps == 500
    theirs = SyncVectorEnv([lambda: gymnasium.make(ID)] * 3, autoreset_mode=AutoresetMode.SAME_STEP)
    assert (vec.observation_space, vec.action_space) == (theirs.observation_space, theirs.action_space)
    assert np.array_equal(vec.reset(seed=8)[0], theirs.reset(seed=8)[0])
    ends = 0
    for action in random_actions(vec, 520):
        ours, other = vec.step(action), theirs.step(action)
        assert all(np.array_equal(a, b) for a, b in zip(ours[:4], other[:4], strict=True))
        assert ("final_obs" in ours[4]) == ("final_obs" in other[4])
        if "final_obs" in ours[4]:
            ended = ours[4]["_final_obs"]
            ends += ended.sum()
            assert np.array_equal(ended, other[4]["_final_obs"])
            assert all(np.array_equal(ours[4]["final_obs"][i], other[4]["final_obs"][i]) for i in np.flatnonzero(ended))
            assert np.array_equal(ours[4]["final_info"]["success"][ended], other[4]["final_info"]["success"][ended])
    assert ends >= 3
    vec.close()


def test_a_mask_resets_only_some():
    vec = gymnasium.make_vec(ID, num_envs=2)
    first, _ = vec.reset(seed=0)
    again, _ = vec.reset(seed=5, options={"reset_mask": np.array([True, False])})
    assert not np.array_equal(first[0], again[0]) and np.array_equal(first[1], again[1])


def test_a_single_one_tells_libraries_of_its_success_and_length():
    env = gymnasium.make(ID)
    assert env.spec.max_episode_steps == 500
    env.reset(seed=0)
    assert env.step(env.unwrapped.environment.env_info["robot"]["joint_pos_limit"][:2] * 0.0)[4]["is_success"] is False


def test_an_episode_of_another_length_is_refused():
    with pytest.raises(ConfigurationError, match="500 steps by the rules, not 100"):
        gymnasium.make_vec(ID, num_envs=1, max_episode_steps=100)


def test_stable_baselines_learns_on_it():
    vec = BatchVecEnv(gymnasium.make_vec(ID, num_envs=2))
    model = PPO("MlpPolicy", vec, n_steps=128, batch_size=128, n_epochs=1, seed=0, device="cpu")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model.learn(1024)
    assert model.num_timesteps == 1024 and len(model.ep_info_buffer) >= 1
    assert model.ep_success_buffer is not None


def test_an_ended_episode_is_told_as_stable_baselines_wants_it():
    vec = BatchVecEnv(gymnasium.make_vec(ID, num_envs=2))
    vec.seed(3)
    assert np.array_equal(vec.reset()[0], gymnasium.make(ID).reset(seed=3)[0])
    for _ in range(500):
        still = np.tile(np.array([vec.env.batch.single.simulation.robot.start, [0.0] * 3]), (2, 1, 1))
        observations, _, done, infos = vec.step(still)
    assert done.all()
    assert infos[0]["TimeLimit.truncated"] and infos[0]["episode"]["l"] == 500 and infos[0]["is_success"] is False
    assert infos[0]["terminal_observation"].shape == observations[0].shape


def test_nobody_imports_stable_baselines_who_does_not_ask_for_it():
    code = (
        "import sys, gymnasium, airhockey.envs.gymnasium; gymnasium.make_vec('airhockey/3dof-hit-v0', num_envs=1); "
        "assert 'torch' not in sys.modules and 'stable_baselines3' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
