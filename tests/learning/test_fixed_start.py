"""Trainings in which something of the puck's start is the same in all episodes (thesis 5.2), and its first reward (5.1)."""

import numpy as np
import pytest

from airhockey.envs.disturbances import load_disturbances
from airhockey.errors import ConfigurationError
from airhockey.learning.pgpe.checks import check
from airhockey.learning.pgpe.records import Settings
from airhockey.learning.pgpe.stage import Stage

POSITION, VELOCITY = slice(0, 3), slice(3, 6)


def starts(fixed: str, name: str = "7dof-hit") -> np.ndarray:
    """The puck's first states in three episodes. Shape (3, 6)."""
    stage = Stage("hit", name, 0.997, load_disturbances("ideal"), fixed=fixed, seed=4)
    rows = []
    for number in range(3):
        seed = np.random.SeedSequence(number)
        stage.place(stage.env.reset(seed=seed), seed)
        rows.append(stage.env.base_observation[:6])
    return np.array(rows)


@pytest.mark.parametrize(
    ("fixed", "same", "other"),
    [("position", POSITION, VELOCITY), ("velocity", VELOCITY, POSITION), ("none", slice(0), slice(0, 6))],
)
def test_what_is_fixed_is_the_same_and_the_rest_is_not(fixed: str, same: slice, other: slice) -> None:
    found = starts(fixed)
    assert np.array_equal(found[0, same], found[1, same]) and np.array_equal(found[0, same], found[2, same])
    assert not np.array_equal(found[0, other], found[1, other])


@pytest.mark.parametrize("name", ["7dof-hit", "3dof-hit"])
def test_both_fix_the_puck_whether_or_not_there_is_an_opponent(name: str) -> None:
    found = starts("both", name)
    assert np.array_equal(found[0], found[1]) and np.array_equal(found[0], found[2])


def test_the_sparse_reward_speaks_at_the_end_only() -> None:
    stage = Stage("hit", "3dof-hit", 0.997, load_disturbances("ideal"), sparse=True)
    env = stage.env
    env.reset(seed=0)
    env.horizon = 3
    action = np.zeros(env.formats[0].shape)
    action[0] = env.simulation.robot.start
    rewards = []
    for _ in range(3):
        state = env.base_observation
        _, _, over, _ = env.step(action)
        rewards.append(stage.reward(env, state, action, env.base_observation, over))
    assert rewards == [0.0, 0.0, -100.0]


def test_another_word_is_refused() -> None:
    with pytest.raises(ConfigurationError, match=r"fixed start 'angle'.*both"):
        check(Settings(fixed_start="angle", names=("hit.theta.0",), mean=(0.01,), sigma=(0.01,)))
