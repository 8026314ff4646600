"""The rules as an environment applies them: what ends an episode or a serve, and where the next one begins."""

import numpy as np
import pytest
from arms import ALL, standing, with_puck

from airhockey import envs
from airhockey.envs.compiled import view
from airhockey.envs.tasks.verdicts import Rules


@ALL
def test_the_compiled_rules_are_the_challenges(name):
    rules = view(envs.make(name)._referee, Rules)
    lengths = rules[:3]
    assert lengths == pytest.approx((0.974, 0.519, 0.125), abs=0)
    assert rules[3:] == pytest.approx((100.0, -0.8, -0.2, 0.39105, 0.1, 0.1, 0.01, 15.0, 3, 0.15, 0.025), abs=1e-12)


@pytest.mark.parametrize(
    ("name", "puck", "absorbing", "success"),
    [
        ("3dof-hit", (0.96, 0.05, 0.0, 2.0, 0.0, 0.0), True, 1),
        ("7dof-hit", (0.96, -0.05, 0.0, 2.0, 0.0, 0.0), True, 1),
        ("7dof-hit", (0.5, 0.2, 0.0, -1.0, 0.0, 0.0), True, 0),
        ("7dof-hit", (-0.5, 0.2, 0.0, -1.0, 0.0, 0.0), False, 0),
        ("3dof-hit", (-0.5, 0.2, 0.0, 0.0, 0.0, 0.0), False, 0),
        ("3dof-hit", (-0.96, 0.05, 0.0, -2.0, 0.0, 0.0), True, 0),  # the wrong goal
        ("3dof-defend", (-0.5, 0.2, 0.0, 0.05, 0.0, 0.0), True, 1),
        ("7dof-defend", (-0.5, 0.2, 0.0, 0.05, 0.3, 0.0), False, 1),
        ("7dof-defend", (0.5, 0.2, 0.0, 1.0, 0.0, 0.0), True, 0),
        ("7dof-defend", (-0.96, 0.0, 0.0, -2.0, 0.0, 0.0), True, 0),
        ("7dof-prepare", (-0.5, 0.2, 0.0, 0.0, 0.0, 0.0), False, 1),
        ("7dof-prepare", (-0.5, 0.45, 0.0, 0.0, 0.0, 0.0), False, 0),
        ("7dof-prepare", (-0.5, 0.005, 0.0, 0.0, 0.0, 0.0), True, 1),
        ("7dof-prepare", (-0.01, 0.2, 0.0, 1.0, 0.0, 0.0), True, 0),
    ],
)
def test_a_step_judges_the_puck(name, puck, absorbing, success):
    env = envs.make(name)
    env.reset(state=with_puck(env, *puck))
    _, reward, over, info = env.step(standing(env))
    assert (over, info["success"]) == (absorbing, success)
    assert reward == 0.0
    assert isinstance(over, bool) and isinstance(info["success"], int)


def serve(env, *puck, limit=800):
    """Play one serve with robots that stand still; its steps and the last `info`."""
    env.reset(state=with_puck(env, *puck))
    for step in range(1, limit):
        _, _, absorbing, info = env.step(standing(env))
        if absorbing:
            return step, info
    raise AssertionError("the serve did not end")


def starts_on(env):
    env.reset()
    return np.sign(env.base_observation[0])


def test_a_goal_counts_and_the_side_that_conceded_serves():
    env = envs.make("tournament")
    env.reset(seed=0)
    assert serve(env, 0.96, 0.05, 0.0, 2.0, 0.0, 0.0)[1]["score"] == [1, 0]
    assert starts_on(env) == 1
    assert serve(env, -0.96, 0.05, 0.0, -2.0, 0.0, 0.0)[1]["score"] == [1, 1]
    assert starts_on(env) == -1
    assert env.score == [1, 1] and env.faults == [0, 0]


def test_the_fault_on_the_752nd_step_of_any_serve_and_the_point_for_the_third():
    env = envs.make("tournament")
    env.reset(seed=0)
    for fault in (1, 2, 3):
        step, info = serve(env, -0.5, 0.2, 0.0, 0.0, 0.0, 0.0)
        assert step == 752
        assert info["faults"] == [fault, 0]
        assert info["score"] == [0, fault // 3]
        assert starts_on(env) == 1


@pytest.mark.parametrize("puck", [(0.1, 0.2, 0.0, 0.0, 0.0, 0.0), (0.3, 0.515, 0.0, 0.0, 20.0, 0.0)])
def test_a_stuck_or_lost_puck_is_served_again_from_the_same_side(puck):
    env = envs.make("tournament")
    for seed in range(4):
        env.reset(seed=seed)
        side = np.sign(env.base_observation[0])
        _, info = serve(env, *puck, limit=20)
        assert info["score"] == info["faults"] == [0, 0]
        assert starts_on(env) == side


def test_a_seed_begins_a_new_game_and_a_reset_without_one_the_next_serve():
    env = envs.make("tournament")
    env.reset(seed=3)
    serve(env, 0.96, 0.05, 0.0, 2.0, 0.0, 0.0)
    env.reset()
    assert env.step(standing(env))[3]["score"] == [1, 0]
    env.reset(seed=3)
    assert env.step(standing(env))[3]["score"] == [0, 0]
    serve(env, 0.96, 0.05, 0.0, 2.0, 0.0, 0.0)
    env.new_game()
    assert env.score == [0, 0] and env.faults == [0, 0]
