"""What went wrong in the episodes of a run: every cause, counted and listed, and shown on request."""

import json
import shutil
from pathlib import Path

import msgspec
import pytest
from click.testing import CliRunner

from airhockey.commands.failures import failures as command
from airhockey.errors import ConfigurationError
from airhockey.evaluator import Options, begin, evaluate
from airhockey.evaluator.analysis.failures import (
    ENDED,
    FAILED,
    TIME_IS_UP,
    by_cause,
    causes_of,
    described,
    failures,
)
from airhockey.evaluator.runs.reader import Run, open_source
from airhockey.evaluator.runs.records import EpisodeRecord
from airhockey.viewing.library import open_library

ENV = "3dof-defend"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Who stands still defends now and then."""
    path = tmp_path_factory.mktemp("failures") / "run"
    evaluate(begin(Options(environments=(ENV,), agent="hold", episodes=8, seed=4), path))
    return path


@pytest.mark.parametrize(
    ("record", "causes"),
    [
        (EpisodeRecord(env=ENV, index=0, success=True, steps=9), ()),
        (EpisodeRecord(env=ENV, index=0, steps=500), (TIME_IS_UP,)),
        (EpisodeRecord(env=ENV, index=0, steps=80, absorbing=True), (ENDED,)),
        (EpisodeRecord(env=ENV, index=0, steps=3, error="step 3: no"), (FAILED,)),
        (EpisodeRecord(env=ENV, index=0, success=True, steps=9, violations={"b": 2, "a": 1, "c": 0}),
         ("violated a", "violated b")),
        (EpisodeRecord(env=ENV, index=0, steps=500, violations={"a": 1}), (TIME_IS_UP, "violated a")),
    ],
)  # fmt: skip
def test_every_cause_has_its_name(record: EpisodeRecord, causes: tuple[str, ...]) -> None:
    assert causes_of(record) == causes


def test_the_episodes_are_those_without_success(folder: Path) -> None:
    run = open_source(folder)
    assert isinstance(run, Run)
    found = failures(run)
    assert [failure.index for failure in found] == [record.index for record in run.records if not record.success]
    assert 0 < len(found) < 8
    assert sum(number for _, _, number in by_cause(found)) == len(found)
    starts = [described(run, record).start for record in found]
    assert all(start is not None and 0.0 < start[0] < 3.0 for start in starts)
    assert [entry.name for entry in open_library(folder).choose(None, failed=True)] == [str(f.index) for f in found]


def test_the_command_lists_and_counts(folder: Path) -> None:
    as_json = json.loads(CliRunner().invoke(command, [str(folder), "--json"]).stdout)
    shown = CliRunner().invoke(command, [str(folder), "--all"]).stdout
    assert f"{len(as_json)} of 8 episodes went wrong" in shown
    assert all(f"│ {failure['index']} " in shown for failure in as_json)
    assert f"hockey replay {folder} --failed" in shown.replace("\n", "")


def test_where_none_went_wrong_none_can_be_shown(folder: Path) -> None:
    library = open_library(folder)
    good = ",".join(entry.name for entry in library.entries if not entry.failed)
    with pytest.raises(ConfigurationError, match="no episode went wrong"):
        library.choose(good, failed=True)
    ran = CliRunner().invoke(command, [str(folder.parent / "nothing")])
    assert isinstance(ran.exception, ConfigurationError)
    assert "there is no such folder" in str(ran.exception)


def test_what_a_strangers_agent_said_is_text(folder: Path, tmp_path: Path) -> None:
    """Neither markup nor control sequences; what stands in brackets is shown, and not taken for a colour."""
    path = Path(shutil.copytree(folder, tmp_path / "copy"))
    (path / "trajectories.h5").unlink()
    said = "step 3: ValueError: [/red][bold]no\x1b[2J\u202e"
    record = EpisodeRecord(env=ENV, index=0, steps=3, error=said)
    (path / "journal.jsonl").write_bytes(msgspec.json.encode(record) + b"\n")
    shown = CliRunner().invoke(command, [str(path)], catch_exceptions=False).stdout
    assert "[/red][bold]no" in shown
    assert not {"\x1b", "\u202e"} & set(shown)
