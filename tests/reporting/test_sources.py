"""Folders in every state: what is there is shown, what is missing is said."""

import contextlib
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from random import Random

import pytest
from results import ENV, EPISODES, Results

from airhockey.errors import ConfigurationError
from airhockey.evaluator import Options
from airhockey.evaluator.evaluation import begin
from airhockey.evaluator.runs.reader import Match, Run, Tournament, Unreadable, open_source, short_name
from airhockey.evaluator.runs.trajectories import read_episodes, write
from airhockey.reporting import report

Copy = Callable[..., Path]


def spoil_manifest(run: Path) -> None:
    (run / "run.json").write_text('{"options": ')


def lose_manifest(run: Path) -> None:
    (run / "run.json").unlink()


def newer_format(run: Path) -> None:
    manifest = json.loads((run / "run.json").read_text())
    (run / "run.json").write_text(json.dumps({**manifest, "format": 2}))


def tear_journal(run: Path) -> None:
    journal = (run / "journal.jsonl").read_bytes()
    (run / "journal.jsonl").write_bytes(journal + b'{"env": "3dof-de')


def lose_journal(run: Path) -> None:
    (run / "journal.jsonl").unlink()


def lose_trajectories(run: Path) -> None:
    (run / "trajectories.h5").unlink()


def cut_trajectories(run: Path) -> None:
    content = (run / "trajectories.h5").read_bytes()
    (run / "trajectories.h5").write_bytes(content[: len(content) // 2])


def foreign_trajectories(run: Path) -> None:
    (run / "trajectories.h5").write_bytes(b"not HDF5 at all")


def leave_segments(run: Path) -> None:
    """As a killed run does: two segments, a broken one, the beginning of another."""
    played = list(read_episodes(run / "trajectories.h5", ENV))
    (run / "trajectories.h5").unlink()
    folder = run / "trajectories"
    folder.mkdir()
    write(folder / "000000.h5", played[:4])
    write(folder / "000001.h5", played[4:7])
    (folder / "000002.broken").write_bytes(b"?")
    (folder / "000003.part").write_bytes(b"?")
    lines = (run / "journal.jsonl").read_bytes().splitlines(keepends=True)
    (run / "journal.jsonl").write_bytes(b"".join(lines[:7]))


@pytest.mark.parametrize(
    ("spoil", "episodes", "said", "has_drawings"),
    [
        (lambda _: None, EPISODES, None, True),
        (spoil_manifest, EPISODES, "run.json", True),
        (lose_manifest, EPISODES, "run.json", True),
        (newer_format, EPISODES, "format 2", True),
        (tear_journal, EPISODES, "1 line of journal.jsonl cannot be read", True),
        (lose_journal, EPISODES, "journal.jsonl", True),
        (lose_trajectories, EPISODES, f"trajectories of {EPISODES} episodes are missing", False),
        (cut_trajectories, EPISODES, "cannot read trajectories.h5", False),
        (foreign_trajectories, EPISODES, "cannot read trajectories.h5", False),
        (leave_segments, 7, f"{ENV} is unfinished: 7 of {EPISODES} episodes", True),
    ],
)
def test_a_run_in_any_state(
    results: Results, copy: Copy, spoil: Callable[[Path], None], episodes: int, said: str | None, has_drawings: bool
) -> None:
    run = copy(results.swings)
    spoil(run)
    source = open_source(run)
    assert isinstance(source, Run)
    assert len(source.records) == episodes
    page, notes = report([run])
    assert bool(notes) == (said is not None)
    if said is not None:
        assert any(said in note for note in notes)
        assert "What is missing" in page
    assert ("Success by the puck&#x27;s start" in page) == has_drawings
    assert f"{episodes:,}" in page


def test_a_broken_segment_is_said(results: Results, copy: Copy) -> None:
    run = copy(results.swings)
    leave_segments(run)
    assert any("000002.broken" in note for note in open_source(run).notes)


@pytest.mark.parametrize("name", ["match", "tournament"])
def test_games_in_any_state(results: Results, copy: Copy, name: str) -> None:
    folder = copy(getattr(results, name))
    films = sorted((folder / "films").iterdir())
    films[0].unlink()
    films[1].write_bytes(b"not HDF5 at all")
    journal = (folder / "journal.jsonl").read_bytes()
    (folder / "journal.jsonl").write_bytes(journal + b'{"job": ')
    (folder / f"{name}.json").write_text("{}")
    source = open_source(folder)
    assert isinstance(source, Match | Tournament)
    page, notes = report([folder])
    for said in (
        "options and versions are unknown",
        "1 film missing",
        f"cannot read films/{films[1].name}",
        "1 line of journal",
    ):
        assert any(said in note for note in notes), said
    assert "Course of the game" in page
    assert ("Standings" in page) == (name == "tournament")


def test_what_holds_nothing_says_why(results: Results, tmp_path: Path) -> None:
    (tmp_path / "foreign").mkdir()
    (tmp_path / "file").touch()
    begin(Options(environments=(ENV,), agent="hold"), tmp_path / "begun").flush()
    (tmp_path / "unplayed").mkdir()
    shutil.copy(results.match / "match.json", tmp_path / "unplayed")
    for name, said in (
        ("nowhere", "no such folder"),
        ("file", "not a folder"),
        ("foreign", "no results"),
        ("begun", "no episode is finished"),
        ("unplayed", "no game is finished"),
    ):
        source = open_source(tmp_path / name)
        assert isinstance(source, Unreadable)
        assert said in source.notes[-1]
        with pytest.raises(ConfigurationError, match=said):
            report([tmp_path / name])


def test_what_holds_something_is_shown_beside_what_does_not(results: Results, tmp_path: Path) -> None:
    page, notes = report([tmp_path / "nowhere", results.holds, results.match])
    assert notes == [f"{tmp_path / 'nowhere'}: there is no such folder"]
    assert "there is no such folder" in page
    assert "Success by the puck" in page and "Course of the game" in page


def test_names_come_without_other_peoples_paths() -> None:
    assert short_name("planner") == "planner"
    assert short_name("/home/somebody/agents/mine") == "mine"
    assert short_name("/home/somebody/mine/air_hockey_agent") == "mine"
    assert short_name("/home/somebody/mine-0.1.0.zip") == "mine-0.1.0"
    assert short_name("tcp://host:1234") == "tcp://host:1234"


def change_bytes(file: Path, random: Random) -> None:
    """Cut a file, overwrite some of its bytes, or replace it."""
    content = bytearray(file.read_bytes())
    ways = random.randrange(3)
    if ways == 0:
        del content[random.randrange(len(content) + 1) :]
    elif ways == 1 and content:
        for _ in range(random.choice([1, 5, 50])):
            content[random.randrange(len(content))] = random.randrange(256)
    else:
        content = bytearray(random.randbytes(1000))
    file.write_bytes(content)


@pytest.mark.parametrize("name", ["swings", "match", "tournament"])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # numbers made of changed bytes overflow
def test_whatever_bytes_changed_there_is_a_page_or_a_reason(results: Results, copy: Copy, name: str) -> None:
    for seed in range(20):
        folder = copy(getattr(results, name), f"copy{seed}")
        random = Random(seed)
        files = sorted(path for path in folder.rglob("*") if path.is_file())
        for file in random.sample(files, min(2, len(files))):
            change_bytes(file, random)
        with contextlib.suppress(ConfigurationError):
            page, _ = report([folder])
            assert page.endswith("</html>\n")


def test_a_line_of_a_journal_that_is_no_text_is_said_and_the_others_are_read(results: Results, copy: Copy) -> None:
    for name, value, read in (("swings", ENV.encode(), EPISODES - 1), ("match", b"hold", 1)):
        folder = copy(getattr(results, name), name)
        lines = (folder / "journal.jsonl").read_bytes().splitlines(keepends=True)
        lines[0] = lines[0].replace(value, value + b"\xff", 1)
        (folder / "journal.jsonl").write_bytes(b"".join(lines))
        for file in folder.glob("*.h5"):
            file.unlink()
        source = open_source(folder)
        assert not isinstance(source, Unreadable)
        assert len(source.records) == read
        assert any("1 line of journal.jsonl cannot be read" in note for note in source.notes)
