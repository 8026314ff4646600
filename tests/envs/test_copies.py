"""Copies of environments and moments that were saved: the same future to the bit, and the original is left as it is."""

import copy
import pickle
import subprocess
import sys
from pathlib import Path

import cloudpickle
import gymnasium
import numpy as np
import pytest
from arms import ALL, episode_bits, standing, swinging, with_puck

import airhockey.envs.gymnasium
from airhockey import envs
from airhockey.envs import random_stream
from airhockey.envs.pettingzoo import TournamentEnv
from airhockey.envs.physics import Physics
from airhockey.envs.tasks import reward_for
from airhockey.errors import ConfigurationError, SimulationError

HERE = Path(__file__).parent
PROFILES = pytest.mark.parametrize("profile", ["ideal", "server", "harsh"])
WAYS = {
    "copy": lambda env: env.copy(),
    "copy.copy": copy.copy,
    "copy.deepcopy": copy.deepcopy,
    "pickle": lambda env: pickle.loads(pickle.dumps(env)),
    "cloudpickle": lambda env: pickle.loads(cloudpickle.dumps(env)),
}
WAY = pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)


def future(env, steps=25):
    """What the environment tells in an episode's rest, after two resets, and of the truth behind it."""
    told = [episode_bits(env, steps)]
    for _ in range(2):
        told += [env.reset().tobytes(), episode_bits(env, 10)]
    data = env.simulation.data
    told += [data.qpos.tobytes(), data.qvel.tobytes(), data.xpos.tobytes(), env.simulation.model.body_mass.tobytes()]
    told.append(repr((env.step_count, env.verdict, env.succeeded, env.score, env.faults, env.game.timer[0])).encode())
    return told


def mid_episode(name, profile):
    """An environment in the middle of its second episode; a game's has a score, a fault nearly due, and a serve behind it."""
    env = envs.make(name, disturbances=profile)
    env.reset(seed=8)
    if env.n_players == 2:
        env.reset(state=with_puck(env, 0.96, 0.05, 0.0, 2.0, 0.0, 0.0))
        while not env.step(standing(env))[2]:
            pass
        assert env.score == [1, 0]
    env.reset()
    for action in swinging(env, 9):
        env.step(action)
    return env


@ALL
@PROFILES
def test_a_copy_has_the_same_future_and_moves_nothing_of_the_original(name, profile):
    env, untouched = mid_episode(name, profile), mid_episode(name, profile)
    twins = [env.copy(), pickle.loads(pickle.dumps(env))]
    expected = future(untouched)
    for twin in (*twins, env):
        assert future(twin) == expected


@WAY
def test_every_way_of_copying_makes_a_real_copy(way):
    env = mid_episode("7dof-hit", "harsh")
    twin = way(env)
    assert type(twin) is type(env) and twin.simulation.data is not env.simulation.data
    assert future(twin) == future(env)


@ALL
@PROFILES
def test_a_saved_moment_comes_back_as_often_as_it_is_wanted(name, profile):
    env = mid_episode(name, profile)
    state = env.get_state()
    expected = future(mid_episode(name, profile))
    for _ in range(2):
        env.set_state(state)
        assert future(env) == expected
    env.reset(seed=3)
    stranger = mid_episode(name, profile)
    stranger.reset(seed=99)
    stranger.state = pickle.loads(pickle.dumps(state))
    assert future(stranger) == expected


@ALL
@PROFILES
def test_saving_changes_nothing_and_a_saved_moment_is_not_changed(name, profile):
    env, silent = mid_episode(name, profile), mid_episode(name, profile)
    state = env.state
    kept = pickle.dumps(state)
    for action in swinging(env, 20):
        told, expected = env.step(action), silent.step(action)
        assert told[0].tobytes() == expected[0].tobytes()
        _ = env.state
        told[0][:] = 1e9
        for array in told[3]["jerk"], *({} if env.n_players == 2 else told[3]["constraints_value"]).values():
            array[:] = 1e9
    env.reset()
    assert pickle.dumps(state) == kept


def test_the_moment_after_a_reset_is_a_moment_too():
    for name in ("7dof-hit", "tournament"):
        env = envs.make(name, disturbances="harsh")
        env.reset(seed=4)
        state, twin = env.get_state(), env.copy()
        first = future(env)
        env.set_state(state)
        assert future(env) == first == future(twin)


def test_many_copies_that_take_turns_keep_apart():
    """As a tree search has it: every branch with actions of its own, none of which reaches another."""
    root = mid_episode("tournament", "server")
    branches = [root.copy() for _ in range(6)]
    alone = []
    for k in range(6):
        env = mid_episode("tournament", "server")
        alone.append(b"".join(env.step(scaled(env, action, k))[0].tobytes() for action in swinging(env, 12)))
    together = [b""] * 6
    for action in swinging(root, 12):
        for k, env in enumerate(branches):
            together[k] += env.step(scaled(env, action, k))[0].tobytes()
    assert together == alone and len(set(alone)) == 6


def scaled(env, action, k):
    start = np.array(env.simulation.robot.start)
    return tuple(np.stack([start + (1.0 + 0.1 * k) * (one[0] - start), one[1]]) for one in action)


@pytest.mark.parametrize("profile", ["harsh"])
def test_copies_go_on_in_another_process(profile, tmp_path):
    environments = [mid_episode(name, profile) for name in ("3dof-hit", "7dof-hit", "tournament")]
    (tmp_path / "copies.pickle").write_bytes(pickle.dumps([(env, env.state) for env in environments]))
    code = (
        f"import sys, pickle; sys.path[:0] = {[str(HERE), str(HERE.parent / 'support')]!r}\n"
        "from test_copies import future\n"
        "copies = pickle.load(open('copies.pickle', 'rb'))\n"
        "told = [future(env) for env, _ in copies]\n"
        "for env, state in copies:\n"
        "    env.reset(seed=1)\n"
        "    env.set_state(state)\n"
        "    told.append(future(env))\n"
        "pickle.dump(told, open('told.pickle', 'wb'))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    expected = [future(env) for env in environments]
    assert pickle.loads((tmp_path / "told.pickle").read_bytes()) == expected * 2


def test_a_copy_outlives_its_original():
    twins = []
    for _ in range(5):
        env = mid_episode("7dof-defend", "harsh")
        expected = future(env.copy())
        twins.append(env.copy())
        del env
    assert all(future(twin) == expected for twin in twins)


def test_what_was_set_on_an_environment_goes_with_it():
    env = envs.make("7dof-hit", interpolation_order=5, visual=True)
    env.horizon, env.env_info["mine"] = 120, [1, 2]
    twin = env.copy()
    assert twin.horizon == 120 and twin.env_info["mine"] == [1, 2]
    twin.env_info["mine"].append(3)
    twin.env_info["rl_info"].action_space.low[:] = 7.0
    assert env.env_info["mine"] == [1, 2] and env.env_info["rl_info"].action_space.low.max() < 7.0
    robot = twin.env_info["robot"]
    assert robot["robot_model"] is twin.simulation.robot_model and robot["robot_data"] is twin.simulation.robot_data
    assert robot["robot_data"] is not env.env_info["robot"]["robot_data"]
    for constraint in twin.env_info["constraints"].constraints.values():
        assert constraint._env_info is twin.env_info
    assert list(twin.env_info) == list(env.env_info) and list(robot) == list(env.env_info["robot"])


def test_a_model_is_shared_where_no_episode_changes_it_and_goes_along_as_it_is():
    env = envs.make("7dof-defend")
    env.simulation.model.geom_solref[:, 1] = 0.77
    env.reset(seed=2)
    twin, far = env.copy(), pickle.loads(pickle.dumps(env))
    assert twin.simulation.model is env.simulation.model and far.simulation.model is not env.simulation.model
    assert future(far) == future(twin) == future(env)
    shaken = envs.make("7dof-defend", disturbances="server")
    assert shaken.copy().simulation.model is not shaken.simulation.model


def test_a_moment_after_the_simulation_failed_is_left_behind():
    env, healthy = mid_episode("7dof-defend", "ideal"), mid_episode("7dof-defend", "ideal")
    state = env.state
    env.simulation.data.qvel[0] = np.nan
    with pytest.raises(SimulationError):
        env.step(standing(env))
    env.state = state
    assert future(env) == future(healthy)


def test_a_moment_of_another_environment_is_refused():
    state = envs.make("7dof-defend").state
    for other in ({"name": "7dof-prepare"}, {"name": "7dof-defend", "disturbances": "server"}):
        with pytest.raises(
            ConfigurationError, match=r"7dof-defend \(orders 3; edition 2023; disturbances ideal\), not of"
        ):
            envs.make(**other).set_state(state)


@ALL
def test_saved_bytes_hold_the_state_that_mujoco_names(name):
    """What `mj_getState` calls the integration state, after the data was scrambled."""
    import mujoco

    env = mid_episode(name, "ideal")
    model, data = env.simulation.model, env.simulation.data
    spec = mujoco.mjtState.mjSTATE_INTEGRATION
    before, after = (np.zeros(mujoco.mj_stateSize(model, spec)) for _ in range(2))
    physics = Physics(data)
    mujoco.mj_getState(model, data, before, spec)
    saved = physics.save()
    mujoco.mj_setState(model, data, np.full_like(before, 0.123), spec)
    physics.restore(saved)
    mujoco.mj_getState(model, data, after, spec)
    assert before.tobytes() == after.tobytes()


@WAY
@pytest.mark.parametrize("name", ["7dof-hit", "tournament"])
def test_the_official_wrapper(name, way):
    np.random.seed(4)
    env = envs.AirHockeyChallengeWrapper(
        name, custom_reward_function=None if name == "tournament" else reward_for("hit")
    )
    env.reset()
    for action in swinging(env._env, 7):
        env.step(action)
    twin, state = way(env), env.get_state()
    drawn = np.random.get_state()[1].tobytes()
    theirs = wrapped_future(twin)
    assert np.random.get_state()[1].tobytes() == drawn  # or the original's next start would be another
    ours = wrapped_future(env)
    env.set_state(state)
    assert ours == theirs == wrapped_future(env)
    assert twin.env_info is twin.base_env.env_info is twin._env.env_info and twin.info is twin.env_info["rl_info"]
    assert twin.base_env.data is twin._env.simulation.data is not env.base_env.data


def wrapped_future(env):
    told = []
    for _ in range(3):
        for action in swinging(env._env, 12):
            observation, reward, absorbing, _ = env.step(action)
            told.append((observation.tobytes(), reward, absorbing))
        told.append(env.reset().tobytes())
    return told


def test_a_seeded_wrapper_draws_from_numpys_generator_again():
    env = envs.AirHockeyChallengeWrapper("3dof-hit")
    twin = env.copy()
    twin.seed(3)
    first = twin.reset()
    np.random.seed(3)
    assert env.reset().tobytes() == first.tobytes()


@WAY
def test_the_gymnasium_environments(way):
    env = gymnasium.make("airhockey/7dof-hit-v0", disturbances="server", reward=reward_for("hit"))
    env.reset(seed=5)
    inner = env.unwrapped
    for action in swinging(inner.environment, 5):
        env.step(action)
    state, twin = inner.get_state(), way(inner)
    expected = gym_future(twin)
    assert gym_future(inner) == expected
    inner.set_state(state)
    assert gym_future(inner) == expected
    assert airhockey.envs.gymnasium.AirHockeyEnv.state.fset is not None


def gym_future(env):
    told = []
    for _ in range(2):
        for action in swinging(env.environment, 15):
            observation, *rest = env.step(action)[:4]
            told.append((observation.tobytes(), *rest))
        told.append(env.reset()[0].tobytes())
    return told


@WAY
def test_the_game_of_two(way):
    env = TournamentEnv(disturbances="harsh", max_cycles=900)
    env.reset(seed=1)
    for _ in range(6):
        env.step(hold_both(env))
    state, twin = env.get_state(), way(env)
    expected = zoo_future(twin)
    assert zoo_future(env) == expected and env.agents == []
    env.set_state(state)
    assert zoo_future(env) == expected


def hold_both(env):
    return dict(zip(("home", "away"), standing(env.environment), strict=True))


def zoo_future(env):
    told = []
    while env.agents:
        observations, rewards, _, truncations, infos = env.step(hold_both(env))
        told.append(
            (observations["away"].tobytes(), rewards, truncations, infos["home"]["score"], infos["away"]["faults"])
        )
    return told


def test_a_simulation_of_its_own_can_be_copied():
    env = mid_episode("7dof-hit", "ideal")
    for way in WAYS.values():
        twin = way(env.simulation)
        assert twin.data is not env.simulation.data and twin.model is not env.simulation.model
        assert twin.data.qpos.tobytes() == env.simulation.data.qpos.tobytes()
        before = env.simulation.data.qpos.tobytes()
        twin.step(np.stack([*[standing(env)] * 2]), np.zeros((0, 2, 7)), 1)
        assert env.simulation.data.qpos.tobytes() == before != twin.data.qpos.tobytes()


@pytest.mark.parametrize("name", ["hit", "hit_single", "tournament"])
def test_the_edition_of_2025(name):
    env = envs.make(name, edition="2025", disturbances="harsh")
    env.reset(seed=4)
    for action in swinging(env, 7):
        env.step(action)
    state, twin, far = env.state, env.copy(), pickle.loads(pickle.dumps(env))
    expected = future(twin)
    assert future(far) == expected == future(env)
    env.state = state
    assert future(env) == expected


@pytest.mark.parametrize("kept", ["bytes", "dictionary"])
def test_a_random_stream_goes_back_to_the_bit(kept, monkeypatch):
    if kept == "dictionary":  # where NumPy keeps a generator's state otherwise
        monkeypatch.setattr(random_stream, "_is_as_expected", lambda: False)
    stream = random_stream.Stream(np.random.default_rng(7))
    stream.generator.integers(0, 2**32, 3, dtype=np.uint32)  # half a draw is left
    state, told = stream.save(), stream.generator.bit_generator.state
    assert isinstance(state, dict) == (kept == "dictionary")

    def draws(random):
        return random.integers(0, 2**32, 3, dtype=np.uint32).tobytes() + random.standard_normal(50).tobytes()

    twins = [way(stream) for way in WAYS.values()]
    expected = draws(stream.generator)
    assert [draws(twin.generator) for twin in twins] == [expected] * len(twins)
    stream.restore(state)
    assert stream.generator.bit_generator.state == told
    assert draws(stream.generator) == expected
    other = random_stream.Stream(np.random.default_rng(8))
    other.restore(state)
    assert draws(other.generator) == expected
    monkeypatch.setattr(random_stream, "_is_as_expected", lambda: kept != "bytes")
    elsewhere = random_stream.Stream(np.random.default_rng(9))  # in a process that keeps it the other way
    elsewhere.restore(state)
    assert draws(elsewhere.generator) == expected


def test_parts_that_hold_addresses_are_copied_with_what_they_point_to():
    env = mid_episode("7dof-hit", "harsh")
    state = env.simulation.save()
    for way in WAYS.values():
        physics, mismatch = way(env.simulation._physics), way(env._mismatch)
        before = env.simulation.data.qpos.tobytes(), env.simulation.model.body_mass.tobytes()
        physics.data.qpos[:] = 0.5
        physics.restore(state.physics)
        assert physics.data.qpos.tobytes() == before[0]
        physics.data.qpos[:] = 0.5
        mismatch.restore(None)
        assert (env.simulation.data.qpos.tobytes(), env.simulation.model.body_mass.tobytes()) == before


@pytest.mark.parametrize("kind", ["PlanarPositionHit", "IiwaPositionTournament", "IiwaPositionDefend", "torques"])
@WAY
def test_the_official_base_environments(kind, way):
    pytest.importorskip("mushroom_rl")
    from airhockey.compat.air_hockey_challenge.environments import iiwas, position_control_wrapper

    np.random.seed(3)
    env = iiwas.AirHockeyHit() if kind == "torques" else getattr(position_control_wrapper, kind)()
    env.reset()
    shape = env.env_info["rl_info"].action_space.low.shape if kind == "torques" else (2, env._n)

    def acted(one, steps):
        random, seen = np.random.default_rng(1), []
        for _ in range(steps):
            action = random.uniform(-0.5, 0.5, shape)
            pair = [action, action] if kind == "IiwaPositionTournament" else action
            seen.append(one.step(pair)[0])
        return np.concatenate(seen).tobytes() + one._data.qpos.tobytes() + one.reset().tobytes()

    acted(env, 3)
    twin, before = way(env), env._data.qpos.tobytes()
    assert twin._data is twin._env.simulation.data and twin._data is not env._data
    assert twin.env_info is twin._env.env_info and twin.info is twin.env_info["rl_info"]
    expected = acted(twin, 5)
    assert env._data.qpos.tobytes() == before
    assert acted(env, 5) == expected
