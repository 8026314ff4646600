"""The Gymnasium and PettingZoo interfaces, judged by those packages' own checkers."""

import subprocess
import sys
import warnings

import gymnasium
import numpy as np
import pettingzoo
import pytest
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import parallel_api_test, parallel_seed_test

import airhockey.envs.gymnasium
from airhockey import envs
from airhockey.agents.hold import standing_still
from airhockey.envs.pettingzoo import IDS
from airhockey.envs.tasks import reward_for
from airhockey.errors import ConfigurationError

TASKS = airhockey.envs.gymnasium.TASKS["2023"]
EVERY_ID = sorted(
    f"{airhockey.envs.gymnasium.NAMESPACES[edition]}/{name}-v0"
    for edition, names in airhockey.envs.gymnasium.TASKS.items()
    for name in names
)


def test_the_ids_are_those_of_the_tasks():
    assert set(TASKS) == set(envs.ENVIRONMENTS) - {"tournament"}
    assert {f"airhockey/{name}-v0" for name in TASKS} <= set(EVERY_ID) <= set(gymnasium.registry)
    assert {id_ for id_ in EVERY_ID if id_.startswith("airhockey2025/")} == {
        f"airhockey2025/{name}-v0" for name in set(envs.edition("2025").environments) - {"tournament"}
    }


def test_an_id_may_name_the_module_that_registers_it():
    code = "import gymnasium; gymnasium.make('airhockey.envs.gymnasium:airhockey/3dof-hit-v0')"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize("name", EVERY_ID)
def test_gymnasiums_checker_is_content(name):
    env = gymnasium.make(name).unwrapped
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        check_env(env, skip_render_check=True)
    told = {str(item.message) for item in caught if "infinity" not in str(item.message)}
    assert not [text for text in told if "observation" in text or "reward" in text]


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5, -1, None])
def test_an_action_has_the_shape_of_the_order(order):
    env = gymnasium.make("airhockey/3dof-hit-v0", interpolation_order=order)
    env.reset(seed=1)
    assert env.action_space.shape == env.unwrapped.environment.formats[0].shape
    env.step(standing_still(np.array(env.unwrapped.environment.simulation.robot.start), order))


def test_an_episode_is_the_environments_own():
    env = gymnasium.make("airhockey/7dof-defend-v0", disturbances="server")
    native = envs.make("7dof-defend", disturbances="server")
    seen, _ = env.reset(seed=7)
    expected = native.reset(seed=7)
    action = standing_still(seen[6:13], 3)
    np.testing.assert_array_equal(seen, expected)
    over = False
    while not over:
        seen, reward, terminated, truncated, info = env.step(action)
        expected, _, absorbing, native_info = native.step(action)
        np.testing.assert_array_equal(seen, expected)
        over = terminated or truncated
        assert terminated == absorbing
        assert reward == (float(info["success"]) if over else 0.0)
    assert info["success"] == native_info["success"]


def test_an_episode_is_truncated_at_the_horizon():
    env = gymnasium.make("airhockey/3dof-hit-v0").unwrapped
    env.reset(seed=0)
    action = standing_still(np.array(env.environment.simulation.robot.start), 3)
    ends = [env.step(action)[2:4] for _ in range(env.environment.horizon)]
    assert ends == [(False, False)] * (env.environment.horizon - 1) + [(False, True)]


def test_a_reward_function_is_given_what_the_wrapper_gives():
    env = gymnasium.make("airhockey/3dof-defend-v0", reward=reward_for("defend"))
    seen, _ = env.reset(seed=3)
    action, rewards, over = standing_still(seen[6:9], 3), [], False
    while not over:
        _, reward, terminated, truncated, info = env.step(action)
        rewards.append(reward)
        over = terminated or truncated
    assert rewards[-1] == (1000.0 if info["success"] else -100.0)
    assert not any(rewards[:-1])


def test_a_bad_argument_says_so():
    with pytest.raises(ConfigurationError, match="windy"):
        gymnasium.make("airhockey/3dof-hit-v0", disturbances="windy")


def test_the_package_is_imported_without_gymnasium():
    code = "import sys, airhockey, airhockey.envs; sys.exit('gymnasium' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize("name", IDS.values())
def test_pettingzoos_checkers_are_content(name):
    parallel_api_test(pettingzoo.make("parallel", name, max_cycles=150), num_cycles=300)
    parallel_seed_test(lambda: pettingzoo.make("parallel", name, max_cycles=30, disturbances="server"))


def test_a_game_goes_on_with_the_next_serve_and_ends_by_truncation():
    game = pettingzoo.make("parallel", IDS["2023"], max_cycles=760)  # a puck that nobody plays is a fault on step 752
    observations, infos = game.reset(seed=1)
    assert all(info["serve"] for info in infos.values())
    action = {player: standing_still(seen[6:13], 3) for player, seen in observations.items()}
    serves, ended = [], False
    while not ended:
        _, rewards, terminations, truncations, infos = game.step(action)
        serves.append(infos["home"]["serve"])
        ended = truncations["home"]
        assert rewards["home"] == -rewards["away"]
        assert not any(terminations.values())
    assert serves.count(True) == 1
    assert len(serves) == 760
    assert game.agents == []
    assert infos["home"]["faults"] + infos["away"]["faults"] == 1
