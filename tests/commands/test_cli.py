"""The command line as a user meets it: what it prints where, and its exit status."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import Hockey

from airhockey import __version__

EVALUATE = [sys.executable, "-m", "airhockey.cli", "evaluate"]
KEYS = [
    "env",
    "agent",
    "episodes",
    "seed",
    "disturbances",
    "success",
    "penalty",
    "deployability",
    "violations",
    "computation_time",
    "agent_errors",
    "inputs",
    "edition",
    "isolation",
    "preparation_time",
]


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ("evaluate --task jump", "'jump'"),
        ("evaluate --task prepare --robot 3dof", "'prepare'"),
        ("evaluate --env 7dof-jump", "'7dof-jump'"),
        ("evaluate --env tournament", "game of two"),
        ("evaluate --env 7dof-hit --task hit", "--task"),
        ("evaluate --env 7dof-hit --robot 3dof", "--robot"),
        ("evaluate --agent nobody", "'nobody'"),
        ("evaluate --agent ./nowhere", "nowhere"),
        ("evaluate --agent {tmp}/nothing", "agent_builder.py"),
        ("evaluate --agent {tmp}/bad_config", "agent_config.yml"),
        ("evaluate --disturbances storm", "'storm'"),
        ("evaluate --disturbances storm.yaml", "storm.yaml"),
        ("evaluate --disturbances {tmp}/broken.yaml", "broken.yaml"),
        ("evaluate --disturbances {tmp}/unknown_key.yaml", "puk"),
        ("evaluate --disturbances {tmp}/negative.yaml", "delay"),
        ("evaluate --episodes 0", "--episodes"),
        ("evaluate --episodes -5", "--episodes"),
        ("evaluate --episodes many", "many"),
        ("evaluate --seed -1", "--seed"),
        ("evaluate --jobs 0", "--jobs"),
        ("evaluate --clock sun", "sun"),
        ("evaluate --agent hold --cluster local:0", "local:"),
        ("evaluate --interpolation-order 7", "'7'"),
        ("evaluate --agent hold --out /proc/nowhere/run", "/proc/nowhere/run"),
        ("evaluate --agent hold --out {tmp}/broken.yaml/run", "broken.yaml"),
        ("evaluate --agent hold --out {tmp}/broken.yaml", "broken.yaml"),
        ("evaluate --agent hold --out {tmp}", "not empty"),
        ("evaluate --resume", "--out"),
        ("evaluate --resume --out nowhere", "nowhere"),
        ("evaluate --resume --out {tmp}", "run.json"),
        ("evaluate --frobnicate", "--frobnicate"),
        ("evaluate 7dof-hit", "7dof-hit"),
        ("frobnicate", "frobnicate"),
    ],
)
def test_bad_input_is_one_line_and_status_2_and_leaves_nothing(
    hockey: Hockey, tmp_path: Path, arguments: str, named: str
) -> None:
    (tmp_path / "broken.yaml").write_text("puck: [1, 2")
    (tmp_path / "unknown_key.yaml").write_text("profile: mine\npuk: {position: 0.1}")
    (tmp_path / "negative.yaml").write_text("profile: mine\ndelay: -1")
    (tmp_path / "nothing").mkdir()
    (tmp_path / "bad_config").mkdir()
    (tmp_path / "bad_config" / "agent_builder.py").write_text("")
    (tmp_path / "bad_config" / "agent_config.yml").write_text("a: [")
    before = sorted(tmp_path.rglob("*"))
    status, out, err = hockey(arguments.replace("{tmp}", str(tmp_path)))
    assert status == 2
    assert out == ""
    assert named in err
    assert err.count("\n") == 1
    assert sorted(tmp_path.rglob("*")) == before


def test_one_task_as_json(hockey: Hockey) -> None:
    status, out, err = hockey(
        "evaluate --env 7dof-hit --agent hold --episodes 2 --seed 5 --jobs 1 --json --disturbances server"
    )
    result = json.loads(out)
    assert status == 0
    assert list(result) == KEYS
    assert (result["env"], result["agent"], result["episodes"], result["seed"]) == ("7dof-hit", "hold", 2, 5)
    assert result["disturbances"] == "server"
    assert set(result["violations"]) == {"joint_pos_constr", "joint_vel_constr", "ee_constr", "link_constr"}
    assert set(result["computation_time"]) == {"mean", "p99", "max", "late"}
    assert 0 < result["computation_time"]["mean"] <= result["computation_time"]["max"]
    assert result["agent_errors"] == 0
    assert "runs/7dof-hit-hold-server-s5" in err
    assert json.loads(Path("runs/7dof-hit-hold-server-s5/result.json").read_text()) == result


@pytest.mark.long
def test_a_cluster_gives_what_this_machine_gives(hockey: Hockey) -> None:
    """But for the time that it took."""
    run = "evaluate --env 3dof-defend --agent hold --episodes 20 --disturbances server --json --quiet"
    here, there = (json.loads(hockey(f"{run} {where}")[1]) for where in ("--jobs 1", "--cluster local:1"))
    for times in ("computation_time", "preparation_time"):
        assert here.pop(times).keys() == there.pop(times).keys()
    assert here == there


def test_every_task_of_a_robot(hockey: Hockey) -> None:
    arguments = "evaluate --task all --robot 3dof --agent hold --episodes 2 --jobs 1 --quiet"
    status, out, err = hockey(arguments)
    assert (status, err) == (0, "")
    for text in ("3dof-hit", "3dof-defend", "95 % interval", "overall: Deployable, phase-1 score 0", "mujoco 4.0"):
        assert text in out
    assert "stored in runs/3dof-all-hold-s0" in out
    status, out, _ = hockey(f"{arguments} --json")
    result = json.loads(out)
    assert list(result) == ["results", "deployability", "phase", "score", "edition"]
    assert [task["env"] for task in result["results"]] == ["3dof-hit", "3dof-defend"]
    assert all(list(task) == KEYS for task in result["results"])
    assert Path("runs/3dof-all-hold-s0-2").is_dir()  # never into another run's folder


def test_progress_goes_to_the_standard_error(hockey: Hockey) -> None:
    status, out, err = hockey("evaluate --env 3dof-defend --agent hold --episodes 20 --jobs 1")
    assert status == 0
    assert "3dof-defend 20/20" in err
    assert "success" in err
    assert "20/20" not in out


def test_a_failing_agent_is_status_3_with_its_reasons(hockey: Hockey, submission: Callable[..., str]) -> None:
    agent = submission("if self.episodes == 1: raise ValueError('stage [fright]')")
    status, out, _ = hockey(f"evaluate --env 3dof-defend --agent {agent} --episodes 3 --jobs 1")
    assert status == 3
    assert "agent failed" in out
    assert "stage [fright]" in out


def test_the_table_says_which_episodes_took_too_long_and_by_which_clock(
    hockey: Hockey, submission: Callable[..., str]
) -> None:
    agent = submission("if self.episodes == 1 and self.steps == 1: time.sleep(0.15)")
    run = f"evaluate --env 3dof-defend --agent {agent} --isolate none --episodes 3 --jobs 1 --quiet"
    for clock, late in (("wall", "[1-9]"), ("cpu", "0")):  # on a loaded machine the wall clock sees more than the sleep
        _, out, _ = hockey(f"{run} --clock {clock}")
        assert re.search(rf"episodes violating computation_time +{late}", out)
        assert re.search(rf"steps over 20 ms +{late}", out)
        assert all(re.search(rf"draw_action {name}, {clock} clock +[\d.]+ ms", out) for name in ("mean", "p99", "max"))


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_what_an_agent_prints_stays_out_of_the_json(hockey: Hockey, submission: Callable[..., str], jobs: str) -> None:
    agent = submission("if self.steps == 1: print('hello'); os.write(1, b'world')")
    status, out, err = hockey(f"evaluate --env 3dof-defend --agent {agent} --episodes 2 --jobs {jobs} --json")
    assert status == 0
    assert json.loads(out)["episodes"] == 2
    assert "hello" in err
    assert "world" in err


def test_a_finished_run_is_shown_again_by_resume(hockey: Hockey) -> None:
    first = "evaluate --env 3dof-defend --agent hold --episodes 2 --jobs 1 --out run --json"
    _, out, _ = hockey(first)
    status, again, _ = hockey(f"{first} --resume")
    assert (status, again) == (0, out)
    status, again, _ = hockey("evaluate --resume --out run --json")
    assert (status, again) == (0, out)
    status, _, err = hockey("evaluate --resume --out run --env 3dof-hit")
    assert status == 2
    assert "3dof-defend" in err


def test_a_users_disturbance_file_may_change_while_the_run_waits(hockey: Hockey, tmp_path: Path) -> None:
    profile = tmp_path / "mine.yaml"
    profile.write_text("profile: mine\npuck: {position: 0.01}\n")
    run = f"evaluate --env 3dof-defend --agent hold --episodes 2 --jobs 1 --out run --json --disturbances {profile}"
    status, out, _ = hockey(run)
    assert (status, json.loads(out)["disturbances"]) == (0, str(profile))
    profile.write_text("profile: mine\npuck: {position: 0.02}\n")
    assert hockey("evaluate --resume --out run --json")[0] == 0
    status, _, err = hockey(f"{run} --resume")
    assert status == 2
    assert "disturbances" in err and "content was another" in err and ", not " not in err


def test_ctrl_c_leaves_a_run_to_resume(submission: Callable[..., str], tmp_path: Path) -> None:
    agent = submission("time.sleep(0.01)")
    command = [*EVALUATE, *f"--env 3dof-defend --agent {agent} --episodes 500 --out run --jobs 2".split()]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True, process_group=0) as process:
        end = time.monotonic() + 30
        while not (tmp_path / "run" / "journal.jsonl").exists():
            assert time.monotonic() < end
            time.sleep(0.05)
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the workers too
        _, err = process.communicate(timeout=20)
    assert process.returncode == 130
    assert "hockey evaluate --resume --out run" in err
    assert "Traceback" not in err


def test_agents_are_listed(hockey: Hockey) -> None:
    status, out, _ = hockey("agents")
    assert status == 0
    assert out.splitlines()[0].split()[0] == "hold"


def test_version_and_help(hockey: Hockey) -> None:
    assert hockey("--version") == (0, f"hockey, version {__version__}\n", "")
    status, out, _ = hockey("--help")
    assert status == 0
    assert "evaluate" in out
    status, out, _ = hockey("evaluate --help")
    assert status == 0
    assert "hockey evaluate --task prepare" in out


@pytest.mark.parametrize("arguments", [["--help"], ["evaluate", "--help"], ["--version"]])
def test_help_imports_nothing_heavy(arguments: list[str]) -> None:
    command = [sys.executable, "-X", "importtime", "-m", "airhockey.cli", *arguments]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stderr
    imported = {line.rsplit("|", 1)[-1].strip() for line in told.splitlines()}
    assert "airhockey.cli" in imported or "rich_click" in imported
    assert not imported & {"numpy", "mujoco", "numba", "h5py", "pinocchio", "torch", "msgspec", "yaml"}


@pytest.mark.parametrize("arguments", [["--help"], ["evaluate", "--help"]])
def test_help_answers_at_once(arguments: list[str]) -> None:
    """Within 0.3 s on an idle machine: CPU time, since other processes may be at work, and the best of a few."""
    command = [sys.executable, "-m", "airhockey.cli", *arguments]
    times = []
    for _ in range(5):
        before = os.times()
        subprocess.run(command, capture_output=True, check=True)
        after = os.times()
        times.append(after.children_user - before.children_user + after.children_system - before.children_system)
    assert min(times) < 0.3
