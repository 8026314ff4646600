"""`--python` and `--set` in games: for everybody whom they fit, or for one player."""

import json
import sys
from pathlib import Path
from typing import Any

import pytest
from command_line import Hockey

from submissions import make_submission

SHORT = "--steps 30 --jobs 1 --quiet"
SAYS_ITS_PYTHON = (
    "import sys; open({mark!r}, 'a').write(sys.executable + '|' + str('airhockey' in sys.modules) + chr(10))"
)


def options(folder: str, manifest: str = "match.json") -> Any:
    return json.loads(Path(folder, manifest).read_text())["options"]


@pytest.fixture
def marked(tmp_path: Path) -> tuple[str, Path]:
    """A submission that writes down which interpreter builds it, and where it does."""
    mark = tmp_path / "mark"
    return make_submission(tmp_path, building=SAYS_ITS_PYTHON.format(mark=str(mark))), mark


@pytest.mark.sampled(2)
@pytest.mark.parametrize("where", ["", "away:"])
def test_a_submission_in_a_match_has_a_python_of_its_own(
    hockey: Hockey, marked: tuple[str, Path], tmp_path: Path, where: str
) -> None:
    agent, mark = marked
    link = tmp_path / "theirs"
    link.symlink_to(sys.executable)
    status, _, err = hockey(f"match hold {agent} {SHORT} --isolate process --python {where}{link} --out run")
    assert status == 0, err
    assert options("run")["python"] == [None, str(link)]
    assert mark.read_text().splitlines()[-1].endswith("|False")  # the guest's side imports nothing of ours
    status, _, err = hockey(f"match hold {agent} --resume --out run --python {sys.executable}")
    assert status == 2 and "has python" in err


def test_settings_are_one_players_or_everybodys(hockey: Hockey) -> None:
    line = f"match thesis thesis {SHORT} --set control.kinematics=compiled --set away:control.solver=dual"
    assert hockey(f"{line} --swap-sides --games 2 --out run")[0] == 0
    assert options("run")["settings"] == [
        ["control.kinematics=compiled"],
        ["control.kinematics=compiled", "control.solver=dual"],
    ]
    jobs = [json.loads(line)["job"] for line in Path("run/journal.jsonl").read_text().splitlines()]
    first, second = sorted(jobs, key=lambda job: job["key"])
    assert first["home_settings"] == second["away_settings"] == ["control.kinematics=compiled"]


@pytest.mark.parametrize(
    ("line", "named"),
    [
        ("match hold hold --python {python}", "fits nobody who plays: hold, hold"),
        ("match hold hold --python home:{python}", "--python is for submissions"),
        ("match hold {agent} --isolate none --python {python}", "--python is for submissions"),
        ("match {agent} {agent} --set control.solver=dual", "fits nobody"),
        ("match hold {agent} --set away:control.solver=dual", "--set is for the players of airhockey"),
        ("match hold hold --set control.sober=dual", "sober"),
        ("match hold {agent} --python nowhere", "'nowhere' is no Python"),
        ("match --resume --out run --python {python}", "name the players, too"),
        ("tournament a=hold b=hold --set c:control.solver=dual", "c:control.solver"),
    ],
)
def test_what_fits_nobody_is_said(hockey: Hockey, marked: tuple[str, Path], line: str, named: str) -> None:
    status, _, err = hockey(line.replace("{python}", sys.executable).replace("{agent}", marked[0]) + " --quiet")
    assert status == 2 and named in err


def test_entries_of_a_tournament(hockey: Hockey, marked: tuple[str, Path], tmp_path: Path) -> None:
    agent, mark = marked
    file = tmp_path / "entries.yaml"
    file.write_text(
        f"- {{name: theirs, agent: {agent}, python: {sys.executable}}}\n"
        "- {name: ours, agent: thesis, settings: [control.solver=dual]}\n"
    )
    line = f"tournament --entries-file {file} {SHORT} --isolate process --out run"
    assert hockey(line)[0] == 0
    entries = {entry["name"]: entry for entry in options("run", "tournament.json")["entries"]}
    assert entries["theirs"]["python"] == sys.executable and entries["ours"]["settings"] == ["control.solver=dual"]
    assert all(text.endswith("|False") for text in mark.read_text().splitlines())
    more = f"tournament --resume --out run theirs={agent} third=hold --python theirs:{{}} --quiet"
    status, _, err = hockey(more.format(file))
    assert status == 2 and "no Python" in err
    other = tmp_path / "other"
    other.symlink_to(sys.executable)
    status, _, err = hockey(more.format(other))
    assert status == 2 and "'theirs' has python" in err
