"""Disturbances read off observations: what was put in is found again, and nothing where nothing was."""

import itertools
import pickle
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from command_line import Hockey

from airhockey.envs.disturbances import Disturbances, JointNoise, OpponentNoise, PuckNoise, TrackLoss, load_disturbances
from airhockey.envs.perception import Perception
from airhockey.envs.specs import IIWA
from airhockey.errors import ConfigurationError
from airhockey.evaluator.analysis.identification import Seen, identify, profile_of

STEPS, EPISODES = 200, 40
DIFFERENT = Disturbances(
    profile="different",
    puck=PuckNoise(position=0.001, yaw=0.02, velocity=0.2, yaw_rate=0.3),
    joints=JointNoise(position=0.001, velocity=0.01, position_bias=0.004),
    opponent=OpponentNoise(position=0.02),
    track_loss=TrackLoss(probability=0.1, length=(2, 4), shows="zero_velocity"),
    delay=3,
)


def seen_under(profile: Disturbances) -> list[Seen]:
    """Episodes in which puck, arm and opponent move smoothly, as a player would see them."""
    random, time = np.random.default_rng(0), 0.02 * np.arange(STEPS + 1)
    found = []
    for _ in range(EPISODES):
        velocity = random.uniform(-0.5, 0.5, 2) * np.exp(-0.2 * time)[:, None]
        place = 0.02 * np.cumsum(velocity, axis=0)
        spin = random.uniform(-3.0, 3.0) * np.ones((len(time), 1))
        turned = (random.uniform(-3.0, 3.0) + 0.02 * np.cumsum(spin, axis=0) + np.pi) % (2.0 * np.pi) - np.pi
        pace = random.uniform(0.5, 3.0, 7)
        joints = np.array(IIWA.start) + 0.3 * (1.0 - np.cos(pace * time[:, None]))
        rates = 0.3 * pace * np.sin(pace * time[:, None])
        swing = np.stack([0.86 + 0.05 * np.sin(6.0 * time), 0.16 * np.sin(3.0 * time), 0.0 * time], axis=1)
        perception = Perception(profile, 7)
        perception.reset(random)
        true = np.concatenate([place, turned, velocity, spin, joints, rates, swing], axis=1)
        found.append(Seen(np.array([perception.observe(row) for row in true]), joints[1:]))
    return found


@pytest.mark.parametrize("profile", [load_disturbances("server"), load_disturbances("harsh"), DIFFERENT])
def test_what_was_put_in_is_found_again(profile: Disturbances) -> None:
    found = profile_of(identify(seen_under(profile), IIWA.start), "found")
    assert found.delay == profile.delay
    assert found.track_loss.length == profile.track_loss.length
    assert found.track_loss.shows == profile.track_loss.shows
    assert found.track_loss.probability == pytest.approx(profile.track_loss.probability, rel=0.15)
    for part, name in (
        ("puck", "position"), ("puck", "yaw"), ("puck", "velocity"), ("puck", "yaw_rate"),
        ("joints", "position"), ("joints", "velocity"), ("opponent", "position"),
    ):  # fmt: skip
        assert getattr(getattr(found, part), name) == pytest.approx(getattr(getattr(profile, part), name), rel=0.05), (
            name
        )
    assert found.joints.position_bias == pytest.approx(profile.joints.position_bias, rel=0.2)


def test_the_standard_error_is_as_large_as_the_error() -> None:
    found = identify(seen_under(DIFFERENT), IIWA.start)["puck.velocity"]
    assert found.spread is not None
    assert abs(found.value - DIFFERENT.puck.velocity) < 5.0 * found.spread < 0.15 * found.value


def test_without_disturbances_nothing_is_found() -> None:
    found = profile_of(identify(seen_under(load_disturbances("ideal")), IIWA.start), "ideal")
    assert found == Disturbances(profile="ideal")


def test_a_delay_without_commands_is_told_by_the_first_observations() -> None:
    silent = [Seen(one.observations) for one in seen_under(DIFFERENT)]
    assert identify(silent, IIWA.start)["delay"].value == DIFFERENT.delay


def test_too_little_is_said() -> None:
    with pytest.raises(ConfigurationError, match=r"100 observations .* takes 200"):
        identify([Seen(seen_under(DIFFERENT)[0].observations[:100])], IIWA.start)


def test_a_run_becomes_a_profile_that_can_be_played_under(hockey: Hockey) -> None:
    run = "evaluate --env 3dof-hit --agent hold --episodes 12 --jobs 1 --quiet"
    assert hockey(f"{run} --disturbances server --out run")[0] == 0
    status, out, _ = hockey("identify run --name as:seen -o seen.yaml")
    assert (status, "seen.yaml" in out) == (0, True)
    found = load_disturbances(Path("seen.yaml"))
    assert found.profile == "as:seen"
    assert found.puck.velocity == pytest.approx(0.05, rel=0.1)
    assert hockey("identify run --env 7dof-hit")[0] == 2


def test_an_official_dataset_is_read_too(hockey: Hockey) -> None:
    transitions = []
    for seen, _ in seen_under(load_disturbances("server"))[:8]:
        rows = [(a, np.zeros(14), 0.0, b, False, False) for a, b in itertools.pairwise(seen)]
        transitions += [*rows[:-1], (*rows[-1][:5], True)]
    Path("7dof-hit").mkdir()
    Path("7dof-hit/dataset.pkl").write_bytes(pickle.dumps(transitions))
    status, out, _ = hockey("identify 7dof-hit/dataset.pkl")
    assert status == 0
    assert "8 episodes of 7dof-hit" in out
    found = msgspec.yaml.decode(out)
    assert found["puck"]["position"] == pytest.approx(0.002, rel=0.05)


@pytest.mark.parametrize(
    ("width", "spoilt", "words"),
    [
        (5, 0.0, "observations of 5 numbers; environments have"),
        (30, 0.0, "observations of 30 numbers; environments have"),
        (20, np.nan, "not finite"),
        (20, "a", "is not a dataset"),
    ],
)
def test_a_dataset_that_no_robot_has_seen_is_refused(hockey: Hockey, width: int, spoilt: Any, words: str) -> None:
    seen = np.full(width, spoilt)
    Path("dataset.pkl").write_bytes(pickle.dumps([(seen, seen, 0.0, seen, False, False)] * 300))
    status, _, err = hockey("identify dataset.pkl")
    assert status == 2
    assert words in " ".join(err.split())
