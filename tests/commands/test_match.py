"""`hockey match` as a user meets it."""

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

KEYS = ["home", "away", "disturbances", "games", "wins", "draws", "losses", "edition"]
GAME_KEYS = {"seed", "steps", "score", "goals", "faults", "penalty", "deployability", "winner", "events"}
SHORT = "--steps 60 --jobs 1"


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ("match", "two players"),
        ("match hold", "two players"),
        ("match hold nobody", "'nobody'"),
        ("match nobody hold", "'nobody'"),
        ("match hold ./nowhere", "nowhere"),
        ("match hold {tmp}", "agent_builder.py"),
        ("match hold hold hold", "hold"),
        ("match hold hold --steps 0", "--steps"),
        ("match hold hold --games 0", "--games"),
        ("match hold hold --seed -1", "--seed"),
        ("match hold hold --jobs 0", "--jobs"),
        ("match hold hold --disturbances storm", "'storm'"),
        ("match hold hold --variant street", "street"),
        ("match hold hold --clock sun", "sun"),
        ("match hold hold --out {tmp}", "not empty"),
        ("match hold hold --out /proc/nowhere/run", "/proc/nowhere/run"),
        ("match hold hold --cluster local:0", "local:"),
        ("match hold hold --cluster local:many", "local:"),
        ("match hold hold --cluster tcp://127.0.0.1:1", "no Dask scheduler"),
        ("match hold hold --cluster nonsense://", "no Dask scheduler"),
        ("match --resume", "--out"),
        ("match --resume --out nowhere", "nowhere"),
        ("match --resume --out {tmp}", "match.json"),
    ],
)
def test_bad_input_is_one_line_and_status_2_and_leaves_nothing(
    hockey: Hockey, tmp_path: Path, arguments: str, named: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("airhockey.evaluator.engines.cluster._PATIENCE", "0.2s")
    (tmp_path / "file").touch()
    before = sorted(tmp_path.rglob("*"))
    status, out, err = hockey(arguments.replace("{tmp}", str(tmp_path)))
    assert status == 2
    assert out == ""
    assert named in err
    assert err.count("\n") == 1
    assert sorted(tmp_path.rglob("*")) == before


def test_a_match_as_json(hockey: Hockey) -> None:
    status, out, err = hockey(f"match hold thesis --games 2 --swap-sides --seed 5 {SHORT} --json")
    result = json.loads(out)
    assert status == 0
    assert list(result) == KEYS
    assert (result["home"], result["away"]) == ("hold", "thesis")
    assert result["wins"] + result["draws"] + result["losses"] == len(result["games"]) == 2
    for game in result["games"]:
        assert set(game) >= GAME_KEYS
        for pair in ("score", "goals", "faults", "penalty", "deployability"):
            assert len(game[pair]) == 2
        assert game["winner"] in ("home", "away", "draw")
        assert game["steps"] == 60
        assert game["events"][0]["what"] == "serve"
        assert {"step", "what"} <= set(game["events"][0])
    assert "stored in runs/match-hold-thesis-s5" in err
    assert json.loads(Path("runs/match-hold-thesis-s5/result.json").read_text()) == result


def test_a_match_as_a_table_with_its_progress_apart(hockey: Hockey) -> None:
    status, out, err = hockey("match hold hold --steps 800 --jobs 1 --out run")
    assert status == 0
    for text in (
        "hold (home)",
        "hold (away)",
        "points by the opponent's faults",
        "episodes violating ee_constr",
        "penalty points",
        "deployability",
        "step   752  fault",
        "its side held the puck for 15.02 s",
        "0 won, 1 drawn, 0 lost",
        "stored in run",
    ):
        assert text in out
    assert "1/1 games" in err
    assert "1/1 games" not in out


def test_a_failing_player_is_status_3_with_its_reason(hockey: Hockey, submission: Callable[..., str]) -> None:
    agent = submission("if self.steps == 5: raise ValueError('stage [fright]')")
    status, out, _ = hockey(f"match hold {agent} {SHORT} --quiet")
    assert status == 3
    assert "stage [fright]" in out
    assert "hold wins" in out


def test_what_a_player_prints_stays_out_of_the_json(hockey: Hockey, submission: Callable[..., str]) -> None:
    agent = submission("if self.steps == 1: print('hello'); os.write(1, b'world')")
    status, out, err = hockey(f"match hold {agent} {SHORT} --json")
    assert (status, json.loads(out)["draws"]) == (0, 1)
    assert "hello" in err
    assert "world" in err


def test_a_finished_match_is_shown_again_by_resume(hockey: Hockey) -> None:
    first = f"match hold hold {SHORT} --out run --json"
    _, out, _ = hockey(first)
    assert hockey("match --resume --out run --json")[:2] == (0, out)
    assert hockey(f"{first} --resume")[:2] == (0, out)
    for other in ("--steps 70", "--seed 1", "--games 3", "--swap-sides", "--variant thesis"):
        status, _, err = hockey(f"match --resume --out run {other}")
        assert status == 2
        assert f"has {other.split()[0].removeprefix('--').replace('-', '_')}" in err


def test_ctrl_c_leaves_a_match_to_resume(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "airhockey.cli", *["match", "hold", "hold", "--steps", "20000", "--out", "run"]]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True, process_group=0) as process:
        end = time.monotonic() + 60
        while not any(b"{" in file.read_bytes() for file in (tmp_path / "run" / "live").glob("*")):
            assert time.monotonic() < end and process.poll() is None
            time.sleep(0.05)
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the workers too
        _, err = process.communicate(timeout=20)
    assert process.returncode == 130
    assert "hockey match --resume --out run" in err
    assert "Traceback" not in err
    assert sorted(path.name for path in (tmp_path / "run").iterdir()) == ["journal.jsonl", "match.json"]


@pytest.mark.parametrize(("clock", "late"), [("wall", 2), ("cpu", 0)])
def test_the_table_says_what_the_clock_saw(
    hockey: Hockey, submission: Callable[..., str], clock: str, late: int
) -> None:
    agent = submission("if self.steps in (3, 7): time.sleep(0.03)")
    line = f"match {agent} hold --steps 20 --isolate none --jobs 1 --clock {clock} --quiet"
    status, out, _ = hockey(line)
    assert status == 0
    assert re.search(rf"steps over 20 ms: command held +{late} +0 ", out)
    assert all(re.search(rf"draw_action {name}, {clock} clock +[\d.]+ ms +[\d.]+ ms", out) for name in ("mean", "max"))
