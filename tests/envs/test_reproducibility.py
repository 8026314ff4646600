"""The same seed gives the same bits, whatever came before and wherever; streams of different owners are independent."""

import hashlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from arms import ALL, episode_bits, standing, swinging

from airhockey import envs
from airhockey.envs.disturbances import Disturbances, JointNoise, Mismatch, PuckNoise

SUPPORT = Path(__file__).parent.parent / "support"
SEEDS = (7, np.random.SeedSequence(7), np.random.SeedSequence(3, spawn_key=(1, 37)))


def digest(env, seed):
    first = env.reset(seed=seed)
    return hashlib.sha256(first.tobytes() + episode_bits(env, 30)).hexdigest()


@ALL
@pytest.mark.parametrize("profile", ["ideal", "server", "harsh"])
def test_a_seed_decides_every_bit_whatever_was_played_before(name, profile):
    fresh, used = envs.make(name, disturbances=profile), envs.make(name, disturbances=profile)
    for length, seed in enumerate((1, None, 2)):
        used.reset(seed=seed)
        episode_bits(used, 5 + length)
    for seed in SEEDS:
        assert digest(used, seed) == digest(fresh, seed)
    assert len({digest(used, seed) for seed in SEEDS}) == 3


def test_another_process_gives_the_same_bits():
    code = (
        f"import sys; sys.path.insert(0, {str(SUPPORT)!r})\n"
        "import hashlib, numpy as np\n"
        "from airhockey import envs\n"
        "from arms import episode_bits\n"
        "for name in envs.ENVIRONMENTS:\n"
        "    env = envs.make(name, disturbances='harsh')\n"
        "    first = env.reset(seed=np.random.SeedSequence(3, spawn_key=(1, 37)))\n"
        "    print(hashlib.sha256(first.tobytes() + episode_bits(env, 30)).hexdigest())\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    here = [digest(envs.make(name, disturbances="harsh"), SEEDS[2]) for name in envs.ENVIRONMENTS]
    assert done.stdout.split() == here


def test_a_seed_sequence_is_not_used_up():
    seed = np.random.SeedSequence(5)
    env = envs.make("7dof-hit", disturbances="harsh")
    told = [digest(env, seed) for _ in range(2)]
    seed.spawn(3)
    assert told == [digest(env, seed)] * 2


def noise_of(env, seed, steps=40):
    """Observation minus truth over an episode at rest. Shape (steps, D)."""
    env.reset(seed=seed)
    rows = []
    for _ in range(steps):
        observation = env.step(standing(env))[0]
        rows.append(observation - env.true_observation)
    return np.array(rows)


SEEN = {"puck": PuckNoise(position=0.01, velocity=0.1), "joints": JointNoise(position=0.01, velocity=0.1)}


def test_perception_does_not_depend_on_what_disturbs_the_plant():
    quiet = envs.make("7dof-hit", disturbances=Disturbances("a", **SEEN))
    plant = Disturbances("b", **SEEN, torque=0.05, mismatch=Mismatch(mass=(0.9, 1.1), rod_length=0.002))
    shaken = envs.make("7dof-hit", disturbances=plant)
    np.testing.assert_allclose(noise_of(quiet, 4), noise_of(shaken, 4), rtol=0, atol=1e-12)


def test_the_start_and_the_plant_do_not_depend_on_perception():
    plant = {"torque": 0.05, "mismatch": Mismatch(mass=(0.9, 1.1), rod_length=0.002)}
    told = []
    for seen in ({}, SEEN):
        env = envs.make("7dof-defend", disturbances=Disturbances("a", **plant, **seen))
        env.reset(seed=4)
        for action in swinging(env, 20):
            env.step(action)
        told.append(env.base_observation.tobytes() + env.simulation.model.body_mass.tobytes())
    assert told[0] == told[1]


def test_noise_of_players_and_seeds_is_uncorrelated():
    env = envs.make("tournament", disturbances=Disturbances("a", **SEEN))
    pairs = noise_of(env, 0, 150).reshape(150, 2, -1)[:, :, :20]
    other = noise_of(env, 1, 150).reshape(150, 2, -1)[:, :, :20]
    noisy = np.r_[0, 1, 3, 4, 6:20]
    for first, second in ((pairs[:, 0], pairs[:, 1]), (pairs[:, 0], other[:, 0]), (pairs[1:, 0], pairs[:-1, 0])):
        a, b = ((noise[:, noisy] / noise[:, noisy].std(axis=0)).ravel() for noise in (first, second))
        assert abs(np.mean(a * b)) < 5.0 / np.sqrt(a.size)


def test_noise_of_plant_and_perception_is_not_the_same_numbers():
    env = envs.make("7dof-defend", disturbances=Disturbances("a", **SEEN, torque=0.01))
    added = []
    step = env.simulation.step
    env.simulation.step = lambda action, noise, k: (added.append(noise), step(action, noise, k))[1]
    seen = noise_of(env, 0, 20)[:, 6:13] / 0.01
    torque = np.array(added) / (0.01 * np.array([320, 320, 176, 176, 110, 40, 40]))
    assert seen.std() == pytest.approx(1.0, rel=0.3) and torque.std() == pytest.approx(1.0, rel=0.1)
    gaps = np.abs(seen.reshape(-1, 1) - torque.reshape(1, -1)).min(axis=1)
    assert (gaps < 1e-9).sum() == 0


@ALL
def test_a_reset_forgets_everything(name):
    """Whatever the controllers, the opponent or the engine remembered: here, nonsense."""
    fresh, poisoned = envs.make(name), envs.make(name)
    simulation = poisoned.simulation
    for part in (simulation._controller, simulation._opponent, simulation._work, poisoned.game):
        for memory in part:
            memory[...] = 123
    simulation.data.qpos[:] = simulation.data.qvel[:] = simulation.data.qacc_warmstart[:] = 9.0
    assert digest(poisoned, 4) == digest(fresh, 4)
    assert poisoned.score == [0, 0] and poisoned.faults == [0, 0]


def test_without_a_seed_every_environment_starts_elsewhere():
    places = set()
    for _ in range(4):
        env = envs.make("3dof-hit")
        env.reset()
        places.add(env.base_observation[:2].tobytes())
    assert len(places) == 4
