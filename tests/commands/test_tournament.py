"""`hockey tournament` as a user meets it."""

import csv
import io
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import Hockey

SHORT = "--steps 20 --jobs 1"


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ("tournament", "at least two entries"),
        ("tournament hold", "at least two entries"),
        ("tournament hold hold", "two entries named 'hold'"),
        ("tournament hold b=nobody", "'nobody'"),
        ("tournament hold b=./nowhere", "nowhere"),
        ("tournament hold b-c=hold", "b-c=hold"),
        ("tournament hold b=hold --phases 3", "--phases"),
        ("tournament hold b=hold --replace b=thesis", "one phase"),
        ("tournament hold b=hold --phases 2 --replace b", "NAME=AGENT"),
        ("tournament hold b=hold --phases 2 --replace c=hold", "'c'"),
        ("tournament hold b=hold --json --csv", "not both"),
        ("tournament hold b=hold --cluster local:x", "local:"),
        ("tournament --entries-file nowhere.yaml", "nowhere.yaml"),
        ("tournament --entries-file {tmp}/broken.yaml", "broken.yaml"),
        ("tournament --entries-file {tmp}/empty.yaml", "empty.yaml"),
        ("tournament --entries-file {tmp}/unknown.yaml", "colour"),
        ("tournament --entries-file {tmp}/phases.yaml", "phases"),
        ("tournament --resume", "--out"),
        ("tournament --resume --out nowhere", "nowhere"),
        ("tournament --show", "--out"),
        ("tournament --show --out nowhere", "nowhere"),
    ],
)
def test_bad_input_is_one_line_and_status_2_and_leaves_nothing(
    hockey: Hockey, tmp_path: Path, arguments: str, named: str
) -> None:
    (tmp_path / "broken.yaml").write_text("- name: [1, 2")
    (tmp_path / "empty.yaml").write_text("")
    (tmp_path / "unknown.yaml").write_text("- {name: a, agent: hold, colour: red}\n- {name: b, agent: hold}")
    (tmp_path / "phases.yaml").write_text("phases: 2\nentries: [{name: a, agent: hold}, {name: b, agent: hold}]")
    before = sorted(tmp_path.rglob("*"))
    status, out, err = hockey(arguments.replace("{tmp}", str(tmp_path)))
    assert status == 2
    assert out == ""
    assert named in err
    assert err.count("\n") == 1
    assert sorted(tmp_path.rglob("*")) == before


def test_entries_of_both_kinds_and_standings_of_every_kind(
    hockey: Hockey, tmp_path: Path, submission: Callable[..., str]
) -> None:
    agent = Path(submission())
    (tmp_path / "entries.yaml").write_text(f"entries:\n- {{name: mine, agent: {agent.name}}}\n")
    status, out, err = hockey(f"tournament hold --entries-file {tmp_path}/entries.yaml {SHORT} --out run")
    assert status == 0
    assert "standings after 2 of 2 games" in out
    for text in ("1/2 games", "2/2 games", "stored in run"):
        assert text in err
    stored = json.loads(Path("run/standings.json").read_text())
    status, out, _ = hockey("tournament --show --out run --json")
    assert (status, json.loads(out)) == (0, stored)
    status, out, _ = hockey("tournament --show --out run --csv")
    assert (status, out) == (0, Path("run/standings.csv").read_text())
    rows = list(csv.DictReader(io.StringIO(out)))
    assert [row["name"] for row in rows] == [row["name"] for row in stored["rows"]] == ["hold", "mine"]
    assert all(row["points"] == "2" for row in rows)
    assert "standings after 2 of 2 games" in hockey("tournament --show --out run")[1]


@pytest.mark.long
def test_extended_on_the_command_line(hockey: Hockey) -> None:
    assert hockey(f"tournament hold b=hold {SHORT} --out run --quiet")[0] == 0
    before = Path("run/journal.jsonl").read_text()
    status, out, _ = hockey("tournament --resume --out run c=hold --phases 2 --replace b=thesis --json --jobs 1")
    assert (status, json.loads(out)["games"]) == (0, 12)
    assert Path("run/journal.jsonl").read_text().startswith(before)
    status, _, err = hockey("tournament --resume --out run --steps 30")
    assert status == 2
    assert "has steps 20, not 30" in err
    status, _, err = hockey("tournament --resume --out run c=thesis")
    assert status == 2
    assert "'c' already" in err


def test_forfeits_are_status_3(hockey: Hockey, submission: Callable[..., str]) -> None:
    status, out, err = hockey(f"tournament hold bad={submission(building='1 / 0')} {SHORT} --csv")
    assert status == 3
    rows = {row["name"]: row for row in csv.DictReader(io.StringIO(out))}
    assert (rows["bad"]["forfeits"], rows["bad"]["lost"], rows["hold"]["won"]) == ("2", "2", "2")
    assert "stored in runs/tournament-s0" in err


@pytest.mark.parametrize("where", ["--jobs 2", pytest.param("--cluster local:2", marks=pytest.mark.long)])
def test_ctrl_c_leaves_a_tournament_to_resume(tmp_path: Path, where: str) -> None:
    line = f"tournament hold b=hold --steps 20000 --out run {where}"
    command = [sys.executable, "-m", "airhockey.cli", *line.split()]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True, process_group=0) as process:
        end = time.monotonic() + 60
        while not any(b"{" in file.read_bytes() for file in (tmp_path / "run" / "live").glob("*")):
            assert time.monotonic() < end and process.poll() is None
            time.sleep(0.05)
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the workers too
        _, err = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "hockey tournament --resume --out run" in err
    assert "Traceback" not in err
