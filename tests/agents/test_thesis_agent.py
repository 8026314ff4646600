"""The rule-based player in play: on every environment, within its limits, whatever it sees."""

import time

import numpy as np
import pytest

from airhockey import envs
from airhockey.agents import build_agent
from airhockey.errors import ConfigurationError

TASKS = [name for name in envs.ENVIRONMENTS if name != "tournament"]


def play(env, agent, seed, steps=500):
    """Success of an episode, the constraints it violated, the phases seen, and the time of each draw."""
    observation = env.reset(seed=seed)
    agent.episode_start()
    violated, phases, times = set(), set(), []
    for _ in range(steps):
        begin = time.thread_time()
        action = agent.draw_action(observation)
        times.append(time.thread_time() - begin)
        phases.add(agent.phase)
        observation, _, over, info = env.step(action)
        violated |= {name for name, value in info["constraints_value"].items() if np.any(value > 0)}
        if over:
            break
    return info["success"], violated, phases, times


@pytest.mark.parametrize("name", TASKS)
def test_plays_each_task_without_a_violation(name):
    env = envs.make(name, disturbances="server")
    agent = build_agent("thesis", env.env_info)
    results = [play(env, agent, seed) for seed in range(6)]
    assert sum(success for success, *_ in results) >= 3  # measured: 80 % to 99 %
    assert not set().union(*(violated for _, violated, *_ in results))
    times = np.concatenate([times for *_, times in results])
    assert np.mean(times) < 1.5e-3  # measured: 0.3 ms on a quiet machine


@pytest.mark.parametrize("name", ["7dof-hit", "7dof-defend", "7dof-prepare"])
def test_plays_with_the_thesiss_parameters(name):
    env = envs.make(name, disturbances="server")
    agent = build_agent("thesis", env.env_info, parameters="thesis")
    for seed in range(2):
        _, violated, *_ = play(env, agent, seed)
        assert not violated


def test_an_episode_does_not_depend_on_those_before_it():
    env = envs.make("7dof-hit", disturbances="server")
    agent = build_agent("thesis", env.env_info)

    def actions(seed):
        observation, drawn = env.reset(seed=seed), []
        agent.episode_start()
        for _ in range(60):
            drawn.append(agent.draw_action(observation))
            observation, *_ = env.step(drawn[-1])
        return np.array(drawn)

    first = actions(3)
    actions(4)
    np.testing.assert_array_equal(actions(3), first)


def test_both_sides_of_a_game_play_and_keep_the_limits():
    env = envs.make("tournament", disturbances="server")
    players = [build_agent("thesis", env.env_info, agent_id=i) for i in (1, 2)]
    observation = env.reset(seed=1)
    for player in players:
        player.episode_start()
    phases = [set(), set()]
    for _ in range(800):
        actions = tuple(p.draw_action(o) for p, o in zip(players, np.split(observation, 2), strict=True))
        observation, _, over, info = env.step(actions)
        for seen, player, values in zip(phases, players, info["constraints_value"], strict=True):
            seen.add(player.phase.split()[0])
            assert all(np.all(value <= 0) for value in values.values())
        if over:
            observation = env.reset()
            for player in players:
                player.episode_start()
    assert all(len(seen) > 1 for seen in phases)


@pytest.mark.parametrize(
    "puck", [(9.0, 9.0), (-9.0, 0.0), (1.51, 0.0), (0.65, 0.0)], ids=["far", "behind", "middle", "on the mallet"]
)
@pytest.mark.parametrize("name", ["7dof-prepare", "3dof-hit"])
def test_no_puck_however_odd_makes_it_raise_or_break_a_limit(name, puck):
    env_info = envs.make(name).env_info
    agent = build_agent("thesis", env_info)
    agent.episode_start()
    n = env_info["robot"]["n_joints"]
    start = agent._controller.state.position
    rng = np.random.default_rng(0)
    for k in range(120):
        velocity = rng.uniform(-20, 20, 3) if k % 2 else np.zeros(3)
        observation = np.concatenate([puck, [0.0], velocity, start, np.zeros(n)])
        action = agent.draw_action(observation)
        assert action.shape == (2, n) and np.isfinite(action).all()
        assert np.all(np.abs(action[0]) <= 0.95 * env_info["robot"]["joint_pos_limit"][1])
        assert np.all(np.abs(action[1]) <= 0.95 * env_info["robot"]["joint_vel_limit"][1])


def test_an_unknown_parameter_file_is_refused():
    with pytest.raises(ConfigurationError, match="unknown parameter file"):
        build_agent("thesis", envs.make("7dof-hit").env_info, parameters="no-such-file")
