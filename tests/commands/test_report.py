"""`hockey report` and `hockey leaderboard` as a user meets them."""

import os
from pathlib import Path

import pytest
from command_line import Hockey
from results import ENV

from airhockey.evaluator import Options, begin, evaluate


@pytest.fixture
def run() -> Path:
    """A finished run in the present folder."""
    path = Path("runs/mine")
    evaluate(begin(Options(environments=(ENV,), agent="hold", episodes=2), path))
    return path


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ("report", "RUN"),
        ("report nowhere", "there is no such folder"),
        ("report {tmp}", "it holds no results"),
        ("report {tmp}/file", "not a folder"),
        ("report nowhere elsewhere", "elsewhere"),
        ("report nowhere -o {tmp}", "is a folder"),
        ("leaderboard", "DIR"),
        ("leaderboard nowhere", "nowhere"),
        ("leaderboard {tmp}", "no results below"),
    ],
)
def test_bad_input_is_one_line_and_status_2_and_leaves_nothing(
    hockey: Hockey, tmp_path: Path, arguments: str, named: str
) -> None:
    (tmp_path / "file").touch()
    before = sorted(tmp_path.rglob("*"))
    status, out, err = hockey(arguments.replace("{tmp}", str(tmp_path)) + (" --quiet" if named != "RUN" else ""))
    assert (status, out) == (2, "")
    assert named in err
    assert err.count("\n") == 1
    assert sorted(tmp_path.rglob("*")) == before


def test_a_report_says_where_it_is_and_what_is_missing(hockey: Hockey, run: Path) -> None:
    status, out, err = hockey(f"report {run} nowhere -o page.html")
    assert status == 0
    assert out.startswith("wrote page.html (") and out.endswith("kB)\n")
    assert "hockey: nowhere: there is no such folder" in err
    assert f"reading {ENV} of {run}" in err
    assert Path("page.html").read_text().startswith("<!doctype html>")
    assert hockey(f"report {run} --quiet") == (0, "", "")
    assert Path("report.html").exists()


def test_a_report_that_cannot_be_written_is_one_line(hockey: Hockey, run: Path) -> None:
    status, out, err = hockey(f"report {run} --quiet -o nowhere/page.html")
    assert (status, out) == (2, "")
    assert "nowhere/page.html" in err and err.count("\n") == 1


def test_a_leaderboard_goes_beside_the_results(hockey: Hockey, run: Path) -> None:
    status, out, _ = hockey("leaderboard runs")
    assert status == 0
    assert out == "wrote 4 pages; open runs/leaderboard/index.html\n"
    assert hockey("leaderboard runs --quiet") == (0, "", "")
    status, _, err = hockey(f"leaderboard runs -o {run} --quiet")
    assert status == 2 and "no leaderboard" in err
    assert sorted(os.listdir("runs")) == ["leaderboard", "mine"]
