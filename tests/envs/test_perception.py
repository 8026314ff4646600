"""What players see: the statistics of every disturbance, and that nobody is judged on it."""

from itertools import pairwise

import msgspec
import numpy as np
import pytest
from arms import ALL, standing, swinging, with_puck

from airhockey import envs
from airhockey.envs.disturbances import Disturbances, JointNoise, OpponentNoise, PuckNoise, TrackLoss
from airhockey.envs.perception import Perception

N = 7
TRUE = np.concatenate([[0.5, 0.1, 0.2, 0.3, 0.4, 0.5], np.linspace(-1.0, 1.0, 2 * N), [2.0, 0.0, 0.1]])


def observed(profile, steps, seed=0, true=TRUE):
    """What is seen of a state that does not change. Shape (steps, D)."""
    perception = Perception(profile, N)
    perception.reset(np.random.default_rng(seed))
    return np.array([perception.observe(true) for _ in range(steps)])


def noise(profile):
    """The profile's noise alone."""
    return msgspec.structs.replace(profile, track_loss=TrackLoss(), delay=0)


def deviations(profile):
    puck, joints = profile.puck, profile.joints
    return np.array(
        [puck.position] * 2
        + [puck.yaw]
        + [puck.velocity] * 2
        + [puck.yaw_rate]
        + [joints.position] * N
        + [joints.velocity] * N
        + [profile.opponent.position] * 3
    )


@pytest.mark.parametrize("name", ["server", "harsh"])
def test_noise_has_the_profiles_deviation_no_mean_and_no_memory(name):
    profile, steps = noise(envs.load_disturbances(name)), 5000
    seen = observed(profile, steps)
    residual = seen - seen.mean(axis=0)
    sigma = deviations(profile)
    np.testing.assert_allclose(residual.std(axis=0), sigma, rtol=5.0 / np.sqrt(2 * steps))
    biased = np.zeros(TRUE.size, dtype=bool)
    biased[:2], biased[6 : 6 + N] = profile.puck.position_bias > 0, profile.joints.position_bias > 0
    unbiased = ((seen.mean(axis=0) - TRUE) / sigma)[~biased]
    assert np.abs(unbiased).max() < 5.0 / np.sqrt(steps)
    whitened = residual / sigma
    assert np.abs((whitened[1:] * whitened[:-1]).mean(axis=0)).max() < 5.0 / np.sqrt(steps)
    between = whitened.T @ whitened / steps - np.eye(TRUE.size)
    assert np.abs(between).max() < 0.1


def test_a_bias_is_constant_in_an_episode_and_drawn_anew_for_the_next():
    profile = Disturbances("b", puck=PuckNoise(position_bias=0.005), joints=JointNoise(position_bias=0.002))
    seen = np.array([observed(profile, 3, seed) for seed in range(800)]) - TRUE
    np.testing.assert_allclose(seen, np.repeat(seen[:, :1], 3, axis=1), atol=1e-15)
    bias = seen[:, 0]
    shifted = np.r_[0, 1, 6 : 6 + N]
    np.testing.assert_allclose(bias[:, :2].std(axis=0), 0.005, rtol=5.0 / np.sqrt(1600))
    np.testing.assert_allclose(bias[:, 6 : 6 + N].std(axis=0), 0.002, rtol=5.0 / np.sqrt(1600))
    assert np.abs(bias[:, shifted].mean(axis=0)).max() < 5.0 * 0.005 / np.sqrt(800)
    assert np.abs(np.delete(bias, shifted, axis=1)).max() < 1e-15


def test_a_noisy_yaw_stays_wrapped():
    true = TRUE.copy()
    true[2] = 3.1
    yaw = observed(Disturbances("y", puck=PuckNoise(yaw=0.1)), 500, true=true)[:, 2]
    assert yaw.min() >= -np.pi and yaw.max() < np.pi
    assert (yaw < 0).any() and (yaw > 0).any()


LOSSES = {"probability": 0.02, "length": (2, 5)}


def lost_runs(seen):
    """Lengths of the runs of steps whose puck position is exactly the one before."""
    lost = np.r_[False, np.all(seen[1:, :2] == seen[:-1, :2], axis=1), False]
    edges = np.flatnonzero(np.diff(lost.astype(int)))
    return lost[1:-1], np.array([end - begin for begin, end in zip(edges[::2], edges[1::2], strict=True)])


def test_losses_are_as_frequent_and_as_long_as_the_profile_says():
    profile = Disturbances("l", puck=PuckNoise(position=0.01), track_loss=TrackLoss(**LOSSES))
    lost, lengths = lost_runs(observed(profile, 20_000))
    seen_between = (1 - 0.02) / 0.02
    assert lost.mean() == pytest.approx(3.5 / (3.5 + seen_between), rel=0.25)
    assert lengths.size == pytest.approx(20_000 / (3.5 + seen_between), rel=0.25)
    assert lengths.min() == 2
    alone = lengths[lengths <= 5]  # longer runs are two losses in a row
    assert (lengths > 5).mean() < 0.1
    for length in (2, 3, 4, 5):
        assert (alone == length).mean() == pytest.approx(0.25, abs=0.12)


@pytest.mark.parametrize("shows", ["hold", "zero_velocity"])
def test_a_lost_track_shows_the_last_seen_puck_and_everything_else_as_it_is(shows):
    profile = Disturbances(
        "s",
        puck=PuckNoise(position=0.01, yaw=0.01, velocity=0.1, yaw_rate=0.1),
        joints=JointNoise(position=0.01),
        opponent=OpponentNoise(position=0.01),
        track_loss=TrackLoss(probability=0.2, length=(1, 3), shows=shows),
    )
    rows = observed(profile, 500)
    lost, _ = lost_runs(rows)
    assert 0.2 < lost.mean() < 0.7
    for is_lost, (before, after) in zip(lost, pairwise(rows), strict=True):
        assert np.all(before[6:13] != after[6:13]) and np.all(before[20:] != after[20:])
        if not is_lost:
            assert np.all(before[:6] != after[:6]) and np.all(after[3:6] != 0.0)
        elif shows == "hold":
            np.testing.assert_array_equal(after[:6], before[:6])
        else:
            np.testing.assert_array_equal(after[:3], before[:3])
            assert np.all(after[3:6] == 0.0)


def test_a_puck_that_was_never_seen_is_shown_as_it_is():
    profile = Disturbances("n", track_loss=TrackLoss(probability=1.0, length=(3, 3)))
    moving = [TRUE + 0.01 * step for step in range(6)]
    perception = Perception(profile, N)
    perception.reset(np.random.default_rng(0))
    rows = np.array([perception.observe(true) for true in moving])
    np.testing.assert_array_equal(rows[:, :6], np.tile(TRUE[:6], (6, 1)))
    np.testing.assert_array_equal(rows[:, 6:], np.array(moving)[:, 6:])


@ALL
@pytest.mark.parametrize("delay", [1, 3])
def test_a_delay_shows_the_observation_of_so_many_steps_ago(name, delay):
    env = envs.make(name, disturbances=Disturbances("d", delay=delay))
    seen = [env.reset(seed=1)]
    true = [env.true_observation]
    for action in swinging(env, 8):
        seen.append(env.step(action)[0])
        true.append(env.true_observation)
    for step, observation in enumerate(seen):
        np.testing.assert_array_equal(observation, true[max(0, step - delay)])


def test_a_delay_only_shifts_what_is_seen_with_its_noise_and_losses():
    prompt = Disturbances("p", puck=PuckNoise(position=0.01), track_loss=TrackLoss(probability=0.2, length=(1, 4)))
    late = msgspec.structs.replace(prompt, delay=3)
    moving = [TRUE + 0.01 * step for step in range(80)]
    told = []
    for profile in (prompt, late):
        perception = Perception(profile, N)
        perception.reset(np.random.default_rng(3))
        told.append(np.array([perception.observe(true) for true in moving]))
    np.testing.assert_array_equal(told[1][3:], told[0][:-3])
    np.testing.assert_array_equal(told[1][:3], told[0][:1].repeat(3, axis=0))


@ALL
def test_ideal_is_the_true_observation_to_the_bit(name):
    env = envs.make(name, disturbances="ideal")
    assert env.reset(seed=1).tobytes() == env.true_observation.tobytes()
    for action in swinging(env, 10):
        assert env.step(action)[0].tobytes() == env.true_observation.tobytes()


@ALL
def test_the_server_disturbs_what_players_see_by_its_deviations(name):
    """Through the whole environment: every entry is disturbed, by about as much as the profile says."""
    profile = noise(envs.load_disturbances("server"))
    env = envs.make(name, disturbances=profile)
    env.reset(seed=1)
    differences = []
    for _ in range(150):
        observation = env.step(standing(env))[0]
        differences.append((observation - env.true_observation).reshape(env.n_players, -1))
    n = env.env_info["robot"]["n_joints"]
    sigma = deviations(profile)
    sigma = np.r_[sigma[:6], sigma[6 : 6 + n], sigma[6 + N : 6 + N + n], sigma[-3:]][: differences[0].shape[1]]
    turned = (np.array(differences) + np.pi) % (2 * np.pi) - np.pi
    np.testing.assert_allclose(turned.std(axis=0), np.tile(sigma, (env.n_players, 1)), rtol=0.4)


@ALL
def test_judging_does_not_see_the_noise(name):
    """An agent that is blind sees a puck a metre away; the rules go by the true one."""
    blind = Disturbances(
        "blind",
        puck=PuckNoise(position=1.0, velocity=10.0),
        joints=JointNoise(position=1.0, velocity=10.0),
        track_loss=TrackLoss(probability=0.5, length=(5, 9)),
        delay=4,
    )
    told = []
    for profile in ("ideal", blind):
        env = envs.make(name, disturbances=profile)
        env.reset(seed=1, state=with_puck(env, 0.88, 0.088, 0.0, 2.0, 0.0, 0.0))
        rows = []
        for action in swinging(env, 12):
            _, _, absorbing, info = env.step(action)
            rows.append((absorbing, info.get("success"), info.get("score"), env.constraint_values.tobytes()))
        told.append(rows)
    assert told[0] == told[1]
    assert any(row[0] for row in told[0])
