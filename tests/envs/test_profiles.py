"""Disturbance profiles as files: the package's hold what disturbances.md says, and a bad one is refused by its key."""

from pathlib import Path

import pytest

from airhockey import envs
from airhockey.envs.disturbances import available
from airhockey.errors import ConfigurationError


def figures(name):
    """A profile in the order of the rows of the project's table."""
    p = envs.load_disturbances(name)
    return {
        "puck position, yaw, bias": (p.puck.position, p.puck.yaw, p.puck.position_bias),
        "puck velocity, yaw rate": (p.puck.velocity, p.puck.yaw_rate),
        "joint position, velocity, bias": (p.joints.position, p.joints.velocity, p.joints.position_bias),
        "opponent": p.opponent.position,
        "track loss": (p.track_loss.probability, *p.track_loss.length, p.track_loss.shows),
        "torque": p.torque,
        "delay": p.delay,
        "masses": p.mismatch.mass,
        "joint friction": p.mismatch.joint_friction,
        "rod length": p.mismatch.rod_length,
        "rim and puck damping": (p.mismatch.rim_damping, p.mismatch.puck_damping),
    }


ROWS = {
    "ideal": [(0, 0, 0), (0, 0), (0, 0, 0), 0, (0, 1, 1, "hold"), 0, 0, (1, 1), (1, 1), 0, ((1, 1), (1, 1))],
    "server": [
        (0.002, 0.04, 0), (0.05, 0.5), (0.0005, 0.005, 0), 0.005, (0.02, 1, 5, "hold"), 0.005, 0,
        (0.95, 1.05), (0.8, 1.2), 0.002, ((0.8, 1.2), (0.8, 1.2)),
    ],
    "harsh": [
        (0.006, 0.1, 0.005), (0.1, 1.0), (0.002, 0.02, 0.002), 0.01, (0.05, 1, 10, "hold"), 0.01, 1,
        (0.9, 1.1), (0.5, 1.5), 0.004, ((0.6, 1.4), (0.6, 1.4)),
    ],
}  # fmt: skip


@pytest.mark.parametrize("name", ROWS)
def test_the_profiles_hold_the_figures_of_the_table(name):
    assert list(figures(name).values()) == ROWS[name]
    assert envs.load_disturbances(name).profile == name
    assert set(available()) == set(ROWS)


def test_a_users_file_fills_the_rest_with_nothing(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("profile: mine\npuck: {position: 0.01}\ndelay: 2\n")
    for given in (path, str(path)):
        profile = envs.load_disturbances(given)
        assert (profile.profile, profile.puck.position, profile.delay) == ("mine", 0.01, 2)
        assert profile.puck.yaw == profile.torque == 0.0
        assert envs.make("3dof-hit", disturbances=given).disturbances == profile
    assert envs.load_disturbances(profile) is profile


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("puk: {position: 1.0}", "puk"),
        ("puck: {positon: 1.0}", "positon"),
        ("mismatch: {masses: [1, 1]}", "masses"),
        ("puck: {position: -0.1}", "puck.position"),
        ("puck: {position: wide}", "puck.position"),
        ("puck: {position: .nan}", "puck.position"),
        ("puck: {position: .inf}", "puck.position"),
        ("puck: {position: [1.0]}", "puck.position"),
        ("puck: null", "puck"),
        ("puck: 0.1", "puck"),
        ("joints: {velocity: true}", "joints.velocity"),
        ("torque: -1.0", "torque"),
        ("delay: 1.5", "delay"),
        ("delay: -1", "delay"),
        ("delay: 101", "delay"),
        ("delay: true", "delay"),
        ("version: one", "version"),
        ("track_loss: {probability: 1.1}", "track_loss.probability"),
        ("track_loss: {length: [5, 1]}", "track_loss.length"),
        ("track_loss: {length: [0, 1]}", "track_loss.length"),
        ("track_loss: {length: [1]}", "track_loss.length"),
        ("track_loss: {length: 3}", "track_loss.length"),
        ("track_loss: {length: [1, 100000000000000000000]}", "track_loss.length"),
        ("track_loss: {shows: nothing}", "track_loss.shows"),
        ("mismatch: {mass: [1.1, 0.9]}", "mismatch.mass"),
        ("mismatch: {mass: [0.0, 1.0]}", "mismatch.mass"),
        ("mismatch: {mass: [1.0, .inf]}", "mismatch.mass"),
        ("mismatch: {joint_friction: [-1, 1]}", "mismatch.joint_friction"),
        ("mismatch: {rim_damping: [2, 1]}", "mismatch.rim_damping"),
        ("mismatch: {puck_damping: [2, 1]}", "mismatch.puck_damping"),
        ("mismatch: {rod_length: -0.1}", "mismatch.rod_length"),
    ],
)
def test_a_bad_value_is_refused_by_its_key(tmp_path, text, key):
    path = tmp_path / "bad.yaml"
    path.write_text(f"profile: bad\n{text}\n")
    with pytest.raises(ConfigurationError) as told:
        envs.load_disturbances(path)
    message = str(told.value)
    assert key in message and "bad.yaml" in message
    assert "\n" not in message


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"- a list",
        b"only text",
        b"3",
        b"torque: 0.1",  # no name
        b"profile: 3",
        b"profile: [unclosed",
        b"profile: a\n\tpuck: b",
        b"profile: !!python/object/apply:os.getcwd []",
        b"profile: a\n3: 4",
        b"&a [*a]",
        b"[" * 1200,
        b"\xff\xfe\x00binary",
        b"profile: a\x00",
    ],
)
def test_a_broken_file_is_refused_by_its_name(tmp_path, content):
    path = tmp_path / "broken.yaml"
    path.write_bytes(content)
    with pytest.raises(ConfigurationError, match=r"broken\.yaml") as told:
        envs.make("3dof-hit", disturbances=path)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("given", ["servr", "hrash", "Ideal"])
def test_an_unknown_name_suggests_the_nearest(given):
    with pytest.raises(ConfigurationError, match=r"Did you mean '(server|harsh|ideal)'"):
        envs.make("3dof-hit", disturbances=given)


@pytest.mark.parametrize("given", ["", "nothing like it", None, 3, ["server"], "a\0b", "x" * 5000])
def test_what_is_no_profile_is_refused(given):
    with pytest.raises(ConfigurationError):
        envs.make("3dof-hit", disturbances=given)


def test_a_missing_file_and_a_folder_are_refused(tmp_path: Path):
    (tmp_path / "folder.yaml").mkdir()
    (tmp_path / "folder").mkdir()
    for name, trouble in (("none.yaml", "no such file"), ("folder.yaml", "not a file"), ("folder", "unknown")):
        with pytest.raises(ConfigurationError, match=trouble):
            envs.make("3dof-hit", disturbances=tmp_path / name)
