"""`hockey train sac` as a user meets it: a run, a kill, its continuation, and bad input."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import msgspec
import pytest
import yaml
from command_line import Hockey

from airhockey.evaluator.runs.disk import write_record
from airhockey.evaluator.runs.manifest import sealed
from airhockey.learning.sac.folder import SkillFolder

SHORT = "train sac --task home --robot 3dof --warm-up 120 --batch 32 --hidden 8"


def test_a_run_says_what_it_reached(hockey: Hockey) -> None:
    status, out, err = hockey(f"{SHORT} --steps 260 --episodes 2 --out run")
    assert status == 0
    assert "2 unseen episodes: success" in out and "run/network.npz" in out
    assert "violations" in err
    card = yaml.safe_load(Path("run/card.yaml").read_text())
    assert card["settings"]["steps"] == 260
    assert card["figures"]["actions"] >= 260
    assert Path("run/network.npz").stat().st_size < 500_000
    status, out, _ = hockey("plot run")
    assert status == 0 and Path(out.strip()).read_bytes().startswith(b"\x89PNG")
    status, _, err = hockey("plot run --sweep 0")
    assert status == 2 and "no θ" in err
    status, _, err = hockey(f"{SHORT} --steps 260 --out run")
    assert status == 2 and "not empty" in err
    status, _, err = hockey("train sac --resume --seed 1 --out run")
    assert status == 2 and "seed 0, not 1" in err


def test_a_killed_run_is_resumed(hockey: Hockey) -> None:
    line = f"{SHORT} --steps 100000 --out run"
    process = subprocess.Popen([sys.executable, "-m", "airhockey.cli", *line.split()], stderr=subprocess.DEVNULL)
    manifest, deadline = Path("run/train.json"), time.monotonic() + 60
    while not manifest.exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    process.send_signal(signal.SIGKILL)
    process.wait()
    begun = SkillFolder.read(Path("run"))
    write_record(
        manifest, sealed(msgspec.structs.replace(begun, options=msgspec.structs.replace(begun.options, steps=200)))
    )
    status, out, _ = hockey("train sac --resume --out run --episodes 1 --quiet")
    assert status == 0 and "1 unseen episodes" in out


def test_an_edited_disturbance_file_is_not_taken_for_the_one_that_the_run_began_with(hockey: Hockey) -> None:
    profile = Path("mine.yaml")
    profile.write_text("profile: mine\npuck: {position: 0.01}\n")
    run = f"{SHORT} --steps 130 --episodes 1 --quiet --out run --disturbances {profile}"
    assert hockey(run)[0] == 0
    manifest = Path("run/train.json").read_bytes()
    assert b'"position": 0.01' in manifest
    profile.write_text("profile: mine\npuck: {position: 0.02}\n")
    status, out, err = hockey(f"{run} --resume")
    assert (status, out) == (2, "")
    assert "disturbances" in err and "content was another" in err and ", not " not in err
    assert hockey("train sac --resume --out run --episodes 1 --quiet")[0] == 0  # goes on with what it began with
    assert Path("run/train.json").read_bytes() == manifest


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ("--resume", "--out FOLDER"),
        ("--optimism 1", "--algorithm oac"),
        ("--disturbances windy", "windy"),
        ("--resume --out nowhere", "no training run"),
        ("--steps 0", "steps"),
        ("--algorithm ppo", "ppo"),
    ],
)
def test_bad_input_is_one_line(hockey: Hockey, arguments: str, named: str) -> None:
    status, out, err = hockey(f"train sac {arguments}")
    assert status == 2 and out == ""
    assert named in err and len(err.splitlines()) == 1
    assert not list(Path.cwd().iterdir())


def test_help_has_examples(hockey: Hockey) -> None:
    status, out, _ = hockey("train sac --help")
    assert status == 0
    assert "hockey train sac --task home" in out
