"""The learners' environments: equal in any batch, no action breaks a rule, and what they say is what players see."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import airhockey.learning.envs.gymnasium as named
from airhockey import envs
from airhockey.agents.atacom.controller import AtacomController
from airhockey.agents.atacom.features import defend_features
from airhockey.agents.control.kinematics import spec_of
from airhockey.agents.estimation.watch import TableWatch
from airhockey.agents.table import BASE_X, HALF_LENGTH, to_table
from airhockey.errors import ActionError, ConfigurationError
from airhockey.learning.envs.batch import LearningBatch
from airhockey.learning.envs.rewards import FAILURE, SUCCESS, goal_line

KINDS = pytest.mark.parametrize(
    ("task", "kind"), [("3dof-defend", "tip"), ("3dof-hit", "joints"), ("3dof-hit", "mallet")]
)


def walk(batch, steps, seed=0):
    """Actions that change now and then, beyond what is allowed."""
    random, shape = np.random.default_rng(seed), (batch.num_envs, *batch.action_shape)
    action = np.zeros(shape)
    for step in range(steps):
        if step % 15 == 0:
            action = random.uniform(-1.5, 1.5, shape)
        yield action


@pytest.mark.long
@KINDS
@pytest.mark.parametrize("disturbances", ["ideal", "server"])
def test_every_environment_of_a_batch_is_what_it_is_alone(task, kind, disturbances):
    made = {"actions": kind, "disturbances": disturbances, "reward": "shaped"}
    every = LearningBatch(task, 3, seed=5, threads=2, **made)
    alone = [LearningBatch(task, 1, seed=5 + i, **made) for i in range(3)]
    ends = 0
    for action in walk(every, 260):
        told = every.step(action)
        for i, one in enumerate(alone):
            assert all(
                part[i].tobytes() == its[0].tobytes()
                for part, its in zip(told, one.step(action[i : i + 1]), strict=True)
            )
        ends += int((told.terminated | told.truncated).sum())
    assert ends >= 3


@KINDS
def test_no_action_violates_a_constraint(task, kind):
    batch = LearningBatch(task, 4, actions=kind, seed=1)
    for action in walk(batch, 300):
        batch.step(action)
    assert batch.learner.played.sum() > 2000
    assert batch.violations == 0.0


def test_features_are_those_of_the_players_own_eyes_and_controller():
    batch = LearningBatch("3dof-defend", 1, repeat=1, seed=2, disturbances="server")
    info = batch.single.env_info
    controller, watch = AtacomController(spec_of(info), info["dt"]), TableWatch(info)
    raw = batch.learner.raw[0]
    controller.reset(raw[info["joint_pos_ids"]])
    watch.see(raw, controller.tip)
    for action in walk(batch, 60):
        told = batch.step(np.clip(action, -1, 1))
        command = controller.step(action[0])
        assert batch.fleet.actions[0, 0, :2].tobytes() == command.tobytes()
        puck, _, _ = watch.see(raw, controller.tip)
        expected = defend_features(puck.state, to_table(controller.tip), controller.tip_velocity)
        np.testing.assert_allclose(told.final_observations[0, :16], expected, atol=1e-6)
        np.testing.assert_allclose(told.final_observations[0, 19:21], [raw[0] + BASE_X, raw[1]], atol=1e-6)
        if told.terminated[0]:
            break


def test_the_rewards_of_an_episode_are_its_end_and_where_it_began():
    batch = LearningBatch("3dof-hit", 1, actions="mallet", seed=4)
    begin, total, weight = batch.learner.potential[0], 0.0, 1.0
    for action in walk(batch, 300):
        told = batch.step(action)
        total, weight = total + weight * told.rewards[0], weight * batch.learner.discount
        if told.terminated[0] or told.truncated[0]:
            break
    last = weight / batch.learner.discount * (SUCCESS if told.success[0] else FAILURE)
    assert total == pytest.approx(last - begin)


def test_progress_is_rewarded_once():
    batch = LearningBatch("3dof-hit", 1, actions="mallet", seed=4, reward="progress")
    begin, total = batch.learner.potential[0], 0.0
    for action in walk(batch, 300):
        told = batch.step(action)
        if told.terminated[0] or told.truncated[0]:
            break
        assert told.rewards[0] >= 0.0
        total += told.rewards[0]
        assert total == pytest.approx(batch.learner.best[0] - begin)
    assert total > 0.0 and told.rewards[0] >= (SUCCESS if told.success[0] else FAILURE)


def test_success_alone_can_be_the_reward_and_the_environments_own_the_observation():
    batch = LearningBatch("3dof-defend", 2, reward="success", observations="raw", seed=0)
    assert batch.reset(seed=3).observations[0].tobytes() == envs.make("3dof-defend").reset(seed=3).tobytes()
    for action in walk(batch, 260):
        told = batch.step(action)
        assert np.array_equal(told.rewards, told.success & (told.terminated | told.truncated))


def test_the_mallet_goes_where_it_is_sent():
    batch = LearningBatch("3dof-hit", 2, actions="mallet", seed=0)
    controls = batch.learner.controls
    for target in ([-0.9, 0.8], [-0.5, -0.9]):  # away from the puck
        for _ in range(60):
            batch.step(np.array([target, target]))
        there = controls.center + controls.half * target - [-BASE_X, 0.0]
        np.testing.assert_allclose(controls.tip, [there, there], atol=0.02)


def test_a_puck_is_followed_to_the_goal_line():
    constants = LearningBatch("3dof-hit", 1).learner.sights.constants
    assert goal_line(np.array([0.0, 0.1, 3.0, 0.0, 0.0]), constants) == pytest.approx(0.1, abs=1e-6)
    assert abs(goal_line(np.array([0.0, 0.0, 2.0, 2.0, 0.0]), constants)) < 0.52
    assert goal_line(np.array([HALF_LENGTH - 0.5, 0.0, 0.01, 0.0, 0.0]), constants) > 1.0


def test_a_saved_moment_has_the_same_future_in_another_batch():
    one, other = (LearningBatch("3dof-defend", 2, seed=seed, disturbances="server") for seed in (1, 2))
    for action in walk(one, 20):
        one.step(action)
    other.set_state(one.get_state())
    for action in walk(one, 60, seed=9):
        assert all(a.tobytes() == b.tobytes() for a, b in zip(one.step(action), other.step(action), strict=True))


@pytest.mark.parametrize("kind", ["tip", "joints"])
def test_gymnasiums_checker_is_content(kind):
    env = gymnasium.make(f"airhockey/3dof-defend-{kind}-v0")
    assert env.spec.max_episode_steps == 250
    check_env(env.unwrapped, skip_render_check=True)


def test_a_single_one_is_a_batch_of_one_over_its_episodes():
    env, vec = (
        gymnasium.make("airhockey/3dof-defend-tip-v0"),
        gymnasium.make_vec("airhockey/3dof-defend-tip-v0", num_envs=1),
    )
    seen, _ = env.reset(seed=1)
    assert np.array_equal(seen, vec.reset(seed=1)[0][0])
    for action in walk(vec.unwrapped.batch, 300):
        seen, reward, terminated, truncated, info = env.step(action[0].clip(-1, 1))
        theirs = vec.step(action.clip(-1, 1))
        assert (reward, terminated, truncated) == (theirs[1][0], theirs[2][0], theirs[3][0])
        assert info["is_success"] == theirs[4]["is_success"][0]
        if terminated or truncated:
            assert np.array_equal(seen, theirs[4]["final_obs"][0])
            seen, _ = env.reset()
        assert np.array_equal(seen, theirs[0][0])


def test_every_task_has_every_kind_of_actions():
    assert {f"airhockey/{task}-{kind}-v0" for task in named.TASKS["2023"] for kind in named.ACTIONS} <= set(
        gymnasium.registry
    )


def test_what_makes_no_sense_is_refused():
    with pytest.raises(ConfigurationError, match=r"kind of actions.*'feet'.*joints"):
        LearningBatch("3dof-hit", 1, actions="feet")
    with pytest.raises(ConfigurationError, match="two players"):
        LearningBatch("tournament", 1)
    with pytest.raises(ConfigurationError, match="0 control steps"):
        LearningBatch("3dof-hit", 1, repeat=0)
    with pytest.raises(ActionError, match="not finite"):
        LearningBatch("3dof-hit", 1).step(np.full((1, 2), np.nan))
