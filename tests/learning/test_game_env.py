"""Games for a learner: the terms of the reward, opponents of any kind, and a future that a saved moment repeats."""

import gymnasium
import numpy as np
import pytest

import airhockey.learning.envs.gymnasium  # noqa: F401 - registers
from airhockey import envs
from airhockey.agents import build_agent
from airhockey.envs.tasks.verdicts import FAULT_HOME, GOAL_AWAY, GOING_ON
from airhockey.errors import ConfigurationError
from airhockey.learning.envs.game import TERMS, WEIGHTS, GameBatch, read_weights


def test_the_opponent_and_the_scene_are_those_of_a_match():
    batch = GameBatch(1, ["thesis"], seed=3)
    env = envs.make("tournament")
    seen = env.reset(seed=3)
    opponent = build_agent("thesis", env.env_info, agent_id=2)
    opponent.episode_start()
    width = seen.size // 2
    for _ in range(40):
        theirs = opponent.draw_action(seen[width:].copy())
        told = batch.step(np.array([[0.3, -0.5]]))
        seen, *_ = env.step(np.stack((batch.fleet.actions[0, 0, :2], theirs)))
        assert batch.learner.raw[0].tobytes() == seen.tobytes()
    assert told.rewards[0] == 0.0 and told.observations.shape == (1, 35)
    assert told.observations[0, 16] < 1.0 or batch.fleet.referees["side"][0, 0] >= 0


def test_events_are_rewarded_by_their_weights():
    batch = GameBatch(2, ["hold"], seed=0)
    still, told = np.zeros((2, 2)), None
    faults = np.zeros(2)
    for _ in range(800):
        told = batch.step(still)
        for name, verdict in (("fault", FAULT_HOME), ("conceded", GOAL_AWAY)):
            assert np.array_equal(batch.terms[name], told.verdicts == verdict)
        assert np.array_equal(told.terminated, told.verdicts != GOING_ON)
        expected = sum(batch.weights[name] * batch.terms[name] for name in TERMS)
        assert np.array_equal(told.rewards, expected)
        faults += batch.terms["fault"] + batch.terms["opponents_fault"]
    assert (faults == 1).all()  # a puck at rest, for 15 s
    assert batch.violations == 0.0


def test_a_saved_moment_has_the_same_future_and_another_opponent_comes_with_the_next_serve():
    one, other = (GameBatch(1, ["thesis"], seed=seed) for seed in (1, 2))
    random = np.random.default_rng(0)
    actions = random.uniform(-1, 1, (60, 1, 2))
    for action in actions[:20]:
        one.step(action)
    other.set_state(one.get_state())
    for action in actions[20:]:
        assert all(a.tobytes() == b.tobytes() for a, b in zip(one.step(action), other.step(action), strict=True))
    one.replace_opponent(0, "hold")
    before = one.opponents[0]
    one.step(actions[0])
    assert one.opponents[0] is before
    one.reset(seed=5)
    assert one.opponents[0] is not before


def test_games_have_a_name_of_gymnasium():
    vec = gymnasium.make_vec("airhockey/tournament-tip-v0", num_envs=2, opponents=["hold"])
    seen, _ = vec.reset(seed=0)
    _, reward, *_ = vec.step(np.zeros((2, 2), np.float32))
    assert seen.shape == (2, 35) and reward.shape == (2,)


def test_what_makes_no_sense_is_refused(tmp_path):
    assert read_weights(WEIGHTS)["conceded"] == -1.0
    file = tmp_path / "weights.yaml"
    file.write_text("goal: 1.0\n")
    with pytest.raises(ConfigurationError, match="a weight to each of goal, conceded"):
        GameBatch(1, weights=file)
    file.write_text(WEIGHTS.read_text().replace("0.6667", "much"))
    with pytest.raises(ConfigurationError, match="goal is 'much'"):
        GameBatch(1, weights=file)
    with pytest.raises(ConfigurationError, match="not 'planner'"):
        GameBatch(1, "planner")
