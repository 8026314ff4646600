"""What every environment keeps to, under every profile and order."""

import numpy as np
import pytest
from arms import ALL, standing, swinging

from airhockey import envs

PROFILES = pytest.mark.parametrize("profile", ["ideal", "harsh"])


def shapes_and_types(env, observation):
    """An observation is what its box and its documentation say."""
    box = env.env_info["rl_info"].observation_space
    assert type(observation) is np.ndarray and observation.dtype == np.float64
    assert observation.shape == (env.n_players * box.shape[0],)
    assert observation.flags["C_CONTIGUOUS"] and observation.flags["WRITEABLE"]


@ALL
@PROFILES
def test_an_environment_conforms(name, profile):
    env = envs.make(name, disturbances=profile)
    n = 3 if name.startswith("3dof") else 7
    assert env.name == name
    assert (env.dt, env.horizon) == (0.02, 45_000 if name == "tournament" else 500)
    assert env.n_agents == (2 if name in ("7dof-hit", "tournament") else 1)
    assert env.n_players == (2 if name == "tournament" else 1)
    assert env.constraint_slices["ee_constr"].stop - env.constraint_slices["ee_constr"].start == 5
    shapes_and_types(env, env.reset(seed=0))
    assert env.step_count == 0
    for count, action in enumerate(swinging(env, 20), start=1):
        result = env.step(action)
        assert len(result) == 4
        observation, reward, absorbing, info = result
        shapes_and_types(env, observation)
        assert type(reward) is float and type(absorbing) is bool
        assert env.step_count == count
        expected = {"constraints_value", "jerk"} | ({"score", "faults"} if env.n_players == 2 else {"success"})
        assert set(info) == expected
        assert info["jerk"].shape == (env.n_agents * n,)
        assert env.constraint_values.shape == ((2,) if env.n_players == 2 else ()) + (4 * n + (7 if n == 7 else 5),)
        assert env.true_observation.shape == observation.shape
    env.reset()
    assert env.step_count == 0


@ALL
def test_undisturbed_observations_lie_in_the_box(name):
    env = envs.make(name)
    box = env.env_info["rl_info"].observation_space
    for seed in range(10):
        rows = [env.reset(seed=seed)]
        for action in swinging(env, 20):
            rows.append(env.step(action)[0])
        seen = np.array(rows).reshape(-1, box.shape[0])
        assert np.all(seen >= box.low) and np.all(seen <= box.high)


@ALL
@PROFILES
def test_what_was_told_stays_and_may_be_changed(name, profile):
    """A caller that keeps everything, and one that scribbles over it, hear the same."""
    keeper, scribbler = envs.make(name, disturbances=profile), envs.make(name, disturbances=profile)
    kept, copies = [keeper.reset(seed=2)], [scribbler.reset(seed=2).copy()]
    for action in swinging(keeper, 15):
        observation, _, _, info = keeper.step(action)
        values = info["constraints_value"] if keeper.n_players == 2 else [info["constraints_value"]]
        kept += [observation, keeper.constraint_values, info["jerk"], *(v for each in values for v in each.values())]
        observation, _, _, info = scribbler.step(action)
        values = info["constraints_value"] if keeper.n_players == 2 else [info["constraints_value"]]
        told = [observation, scribbler.constraint_values, info["jerk"], *(v for each in values for v in each.values())]
        copies += [array.copy() for array in told]
        truth = scribbler.true_observation
        for array in (*told, truth, scribbler.base_observation):
            array[:] = 1e9
    assert all(np.array_equal(first, second) for first, second in zip(kept, copies, strict=True))


@ALL
@pytest.mark.parametrize("order", [1, 2, 3, 4, 5, -1, None])
def test_every_order_keeps_a_standing_robot_in_place(name, order):
    env = envs.make(name, interpolation_order=order)
    env.reset(seed=0)
    start = np.array(env.simulation.robot.start)
    for _ in range(10):
        observation = env.step(standing(env, order))[0]
        joints = observation[6 : 6 + start.size]
        np.testing.assert_allclose(joints, start, atol=0.01)


@ALL
@PROFILES
def test_an_environment_can_be_stepped_at_once(name, profile):
    env = envs.make(name, disturbances=profile)
    shapes_and_types(env, env.step(standing(env))[0])


def test_a_freely_sliding_puck_slows_down_exponentially():
    """Damping 0.005 N·s/m on 0.01 kg: a time constant of two seconds."""
    env = envs.make("3dof-hit")
    rows = env.base_observation
    rows[:6] = [-0.3, 0.3, 0.0, 0.4, 0.0, 3.0]
    env.reset(state=rows)
    for step in range(1, 101):
        observation = env.step(standing(env))[0]
        assert observation[3] == pytest.approx(0.4 * np.exp(-0.02 * step / 2.0), rel=1e-3)
        assert observation[5] == pytest.approx(3.0 * np.exp(-0.02 * step * 2e-6 / 5e-6), rel=1e-3)
        travelled = 0.4 * 2.0 * (1.0 - np.exp(-0.02 * step / 2.0))
        assert observation[0] - 1.51 + 0.3 == pytest.approx(travelled, abs=1e-3)
