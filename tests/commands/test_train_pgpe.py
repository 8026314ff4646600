"""`hockey train pgpe`, `hockey plot` and `hockey evaluate --parameters` as a user meets them."""

import json
from pathlib import Path

import pytest
from command_line import Hockey

from airhockey.agents.thesis.parameters import thesis_parameters
from airhockey.learning.pgpe.trainable import as_yaml, replaced

SHORT = "--robot 3dof --iterations 2 --candidates 2 --episodes 1 --jobs 1 --only hit.theta.0"


def test_a_run_its_parameters_its_pictures_and_its_continuation(hockey: Hockey) -> None:
    status, out, err = hockey(f"train pgpe {SHORT} --out run")
    assert status == 0
    assert "iteration 2: return" in out and "hit.theta.0" in out and "run/parameters.yaml" in out
    assert "1/2" in err and "success" in err
    status, out, _ = hockey("train pgpe --resume --out run --iterations 3 --quiet --jobs 1")
    assert status == 0 and "iteration 3: return" in out
    status, out, _ = hockey("plot run --sweep 0 --points 2 --episodes 1 --jobs 1")
    assert status == 0
    assert [Path(line).name for line in out.split()] == [
        "learning_curve.png",
        "parameters.png",
        "updates.png",
        "sweep-hit.theta.0.png",
    ]
    played = "--env 3dof-hit --episodes 1 --jobs 1 --json --quiet"
    status, out, _ = hockey(f"evaluate {played} --parameters run/parameters.yaml")
    assert status == 0 and json.loads(out)["success"] == 1.0
    lame = replaced(thesis_parameters("run/parameters.yaml"), {"hit.longest_step": 0.0, "hit.fastest_step": 0.0})
    Path("lame.yaml").write_text(as_yaml(lame))
    status, out, _ = hockey(f"evaluate {played} --parameters lame.yaml")
    assert status == 0 and json.loads(out)["success"] == 0.0


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ("train pgpe --task score", "'score'"),
        ("train pgpe --task prepare --robot 3dof", "no task 'prepare' for the 3dof robot"),
        ("train pgpe --init nowhere.yaml", "'nowhere.yaml'"),
        ("train pgpe --set hit.theta.0=fast", "'hit.theta.0=fast'"),
        ("train pgpe --set hit.speed=1", "'hit.speed'"),
        ("train pgpe --set hit.theta.0=9", "must be from 0 to 0.5"),
        ("train pgpe --fix 9", "indices 0 to 3"),
        ("train pgpe --only 1 --fix 2", "leave out --fix"),
        ("train pgpe --sigma 0", "sigma"),
        ("train pgpe --candidates 1", "candidates"),
        ("train pgpe --disturbances stormy", "'stormy'"),
        ("train pgpe --resume", "--out"),
        ("train pgpe --resume --out nothing", "no training run"),
        ("train jump", "'jump'"),
        ("plot nothing", "no training run"),
        ("evaluate --env 3dof-hit --parameters nowhere.yaml", "'nowhere.yaml'"),
        ("evaluate --env 3dof-hit --agent hold --parameters tuned", "reads no parameter file"),
    ],
)
def test_bad_input_is_one_line_and_status_2(hockey: Hockey, arguments: str, named: str) -> None:
    status, out, err = hockey(arguments)
    assert (status, out) == (2, "")
    assert named in err and err.count("\n") == 1
    assert not Path("runs").exists()


def test_a_folder_in_use_is_not_begun_again(hockey: Hockey) -> None:
    Path("run").mkdir()
    (Path("run") / "notes.txt").touch()
    status, _, err = hockey(f"train pgpe {SHORT} --out run")
    assert status == 2 and "not empty" in err


def test_a_run_that_diverges_says_so_and_keeps_its_parameters(hockey: Hockey) -> None:
    status, out, err = hockey(f"train pgpe {SHORT} --iterations 40 --learning-rate 60 --out run --quiet")
    assert status == 4
    assert "diverged: σ" in err
    assert "last good" in out or "no iteration was finished" in err
