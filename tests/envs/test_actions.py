"""Bad actions are refused before the engine sees them, and what was fine before is fine after."""

import os
import subprocess
import sys
import threading

import numpy as np
import pytest
from arms import ALL, episode_bits, standing, swinging, with_puck

from airhockey import envs
from airhockey.errors import ActionError, AirHockeyError, SimulationError

START = np.zeros((2, 7))
BAD = {
    "no array": None,
    "text": "forward",
    "a list of text": [["1"] * 7] * 2,
    "an object": object(),
    "objects": np.array([[None] * 7] * 2),
    "a number": 1.0,
    "nothing": [],
    "ragged": [[0.0] * 7, [0.0] * 6],
    "a dictionary": {"position": START[0], "velocity": START[1]},
    "complex": START + 0j,
    "booleans": START.astype(bool),
    "dates": np.zeros((2, 7), dtype="datetime64[s]"),
    "records": np.zeros((2, 7), dtype=[("a", float)]),
    "one row": np.zeros(7),
    "a row too many": np.zeros((3, 7)),
    "transposed": np.zeros((7, 2)),
    "a joint too few": np.zeros((2, 6)),
    "a batch": np.zeros((1, 2, 7)),
    "a trajectory": np.zeros((20, 3, 7)),
    "empty": np.zeros((0, 7)),
    "not a number": np.full((2, 7), np.nan),
    "one infinity": np.where(np.eye(2, 7) > 0, np.inf, 0.0),
    "single precision not a number": np.full((2, 7), np.nan, dtype=np.float32),
    "larger than any": np.full((2, 7), 1.7e308),
}


@pytest.fixture(scope="module")
def env():
    return envs.make("7dof-prepare")


@pytest.fixture(scope="module")
def healthy(env):
    """What an episode tells that no bad action came before."""
    env.reset(seed=5)
    return episode_bits(env, 10)


@pytest.mark.parametrize("action", BAD.values(), ids=BAD)
def test_a_bad_action_is_refused_by_name_of_the_step_and_a_reset_heals(env, healthy, action):
    env.reset(seed=6)
    env.step(standing(env))
    with pytest.raises(ActionError, match="step 2") as told:
        env.step(action)
    assert "\n" not in str(told.value)
    env.reset(seed=5)
    assert episode_bits(env, 10) == healthy


@pytest.mark.parametrize("kind", ["not a number", "a joint too few", "text"])
def test_nothing_moves_by_a_refused_action(env, kind):
    env.reset(seed=6)
    env.step(standing(env))
    data = env.simulation.data
    before = (data.qpos.tobytes(), data.qvel.tobytes(), data.time, env.true_observation.tobytes())
    with pytest.raises(ActionError):
        env.step(BAD[kind])
    assert (data.qpos.tobytes(), data.qvel.tobytes(), data.time, env.true_observation.tobytes()) == before


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5, -1, None])
@pytest.mark.parametrize("size", [1e12, 1e100, 1e300, 1.7e308])
def test_a_huge_action_is_limited_or_refused_but_never_harms(order, size):
    for name in ("3dof-hit", "7dof-hit"):
        env = envs.make(name, interpolation_order=order)
        env.reset(seed=0)
        calm = standing(env, order)
        for action in (np.full_like(calm, size), np.full_like(calm, -size), calm):
            try:
                observation, *_ = env.step(action)
            except ActionError:
                break
            assert np.isfinite(observation).all() and np.isfinite(env.constraint_values).all()
            assert np.abs(observation).max() < 1e3
        env.reset(seed=0)
        assert np.isfinite(env.step(calm)[0]).all()


def test_a_huge_action_is_not_blamed_on_the_next_one():
    env = envs.make("3dof-hit", interpolation_order=1)
    env.reset(seed=0)
    with pytest.raises(ActionError, match="step 1"):
        env.step(np.full(3, 1.7e308))


@pytest.mark.parametrize(
    "same",
    [
        lambda action: action.tolist(),
        lambda action: tuple(map(tuple, action)),
        np.asfortranarray,
        lambda action: np.repeat(action, 2, axis=1)[:, ::2],
        lambda action: action.astype(np.float32),
        lambda action: action.astype(">f8"),
        np.ma.asarray,
    ],
)
def test_the_same_numbers_in_another_form_are_the_same_action(env, same):
    action = standing(env).astype(np.float32).astype(np.float64)
    told = []
    for form in (action, same(action)):
        env.reset(seed=1)
        told.append(env.step(form)[0].tobytes())
    assert told[0] == told[1]


def test_whole_numbers_are_numbers(env):
    env.reset(seed=1)
    assert np.isfinite(env.step([[0] * 7] * 2)[0]).all()


def test_an_action_is_read_and_not_kept(env):
    env.reset(seed=1)
    action = standing(env)
    before = action.copy()
    env.step(action)
    np.testing.assert_array_equal(action, before)
    action[:] = 1e9
    assert np.isfinite(env.step(before)[0]).all()


GOOD = np.tile(standing(envs.make("7dof-prepare")), (2, 1, 1))


@pytest.mark.parametrize(
    ("pair", "message"),
    [
        (None, "pair"),
        (GOOD[0], "player 1"),
        ((GOOD[0],), "pair"),
        ((GOOD[0], GOOD[0], GOOD[0]), "pair"),
        ({"a": GOOD[0], "b": GOOD[0]}, "pair"),
        ("ab", "pair"),
        ((GOOD[0], None), "player 2"),
        ((np.full((2, 7), np.nan), GOOD[0]), "finite"),
        ((GOOD[0], np.full((2, 7), np.inf)), "finite"),
        ((GOOD[0][0], GOOD[0]), "player 1"),
        ((GOOD[0], GOOD[0][:, :6]), "player 2"),
    ],
)
def test_bad_pairs_are_refused_and_say_whose_action_it_was(pair, message):
    env = envs.make("tournament")
    env.reset(seed=0)
    with pytest.raises(ActionError, match=message):
        env.step(pair)
    env.reset(seed=0)
    assert np.isfinite(env.step((GOOD[0], GOOD[1]))[0]).all()


def test_pairs_in_any_form_are_the_same_pair():
    env = envs.make("tournament")
    told = []
    for pair in ((GOOD[0], GOOD[1]), [GOOD[0], GOOD[1]], GOOD, GOOD.tolist()):
        env.reset(seed=0)
        told.append(env.step(pair)[0].tobytes())
    assert len(set(told)) == 1


def test_each_player_plays_its_own_order():
    mixed = envs.make("tournament", interpolation_order=(5, 1))
    mixed.reset(seed=0)
    mixed.step((np.vstack([GOOD[0], np.zeros(7)]), GOOD[0][0]))
    with pytest.raises(ActionError, match="player 2"):
        mixed.step((np.vstack([GOOD[0], np.zeros(7)]), GOOD[0]))


@ALL
@pytest.mark.parametrize("place", ["qpos", "qvel"])
@pytest.mark.parametrize("value", [np.nan, np.inf, 1e12])
@pytest.mark.parametrize("index", [0, -1])
def test_a_diverged_state_is_an_error_that_names_the_step(name, place, value, index):
    env = envs.make(name)
    env.reset(seed=0)
    env.step(standing(env))
    getattr(env.simulation.data, place)[index] = value
    with pytest.raises(SimulationError, match="step 2"):
        env.step(standing(env))
    env.reset(seed=5)
    fresh = envs.make(name)
    fresh.reset(seed=5)
    assert episode_bits(env, 5) == episode_bits(fresh, 5)


def test_warnings_become_messages_and_leave_no_log(tmp_path):
    program = """
import numpy as np
from airhockey import envs
from airhockey.errors import SimulationError
env = envs.make("3dof-hit")
for value in (np.nan, 1e12):
    env.reset(seed=0)
    env.simulation.data.qpos[-1] = value
    try:
        env.step(np.stack([env.simulation.robot.start, np.zeros(3)]))
    except SimulationError as error:
        print(error)
"""
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    assert len(lines) == 2
    assert all(line.startswith("step 1: MuJoCo warned (badqpos") and "QPOS" in line for line in lines)
    assert done.stderr == ""
    assert os.listdir(tmp_path) == []


def test_a_warning_in_one_thread_is_no_error_in_another():
    calm, ill = envs.make("7dof-defend"), envs.make("3dof-hit")
    failures = []

    def play_ill():
        for _ in range(30):
            ill.reset(seed=0)
            ill.simulation.data.qpos[-1] = 1e12
            try:
                ill.step(standing(ill))
            except SimulationError as error:
                failures.append(error)

    calm.reset(seed=1)
    alone = episode_bits(calm, 60)
    calm.reset(seed=1)
    thread = threading.Thread(target=play_ill)
    thread.start()
    together = episode_bits(calm, 60)
    thread.join()
    assert together == alone
    assert len(failures) == 30


@pytest.mark.parametrize(
    "state", [np.zeros(3), np.zeros((2, 20)), np.full(20, np.nan), np.zeros(0), np.full(20, np.inf)]
)
def test_a_state_to_reset_to_is_checked(env, state):
    with pytest.raises(AirHockeyError, match="20 finite numbers"):
        env.reset(state=state)


def test_a_puck_shot_through_everything_is_no_error():
    """Fast, but physical: the episode ends, the simulation does not."""
    env = envs.make("3dof-hit")
    env.reset(state=with_puck(env, 0.0, 0.0, 0.0, 90.0, 30.0, 10.0))
    for action in swinging(env, 20):
        env.step(action)
