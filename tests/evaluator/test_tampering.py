"""A run's folder that somebody edited while the run waited: refused by name, or mended, and said so."""

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from airhockey.errors import ConfigurationError
from airhockey.evaluator import evaluation
from airhockey.evaluator.match import MatchOptions, begin_match, play_match, resume_match
from airhockey.evaluator.runs.game_records import GameOptions
from airhockey.evaluator.runs.reader import open_source
from airhockey.evaluator.runs.records import Options
from airhockey.inputs.hashing import content_hash

HOLDING = MatchOptions(home="hold", away="hold", games=2, game=GameOptions(steps=60))
PROFILE = "profile: mine\ndelay: 1\n"


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished match."""
    path = tmp_path_factory.mktemp("match") / "run"
    play_match(begin_match(HOLDING, path))
    return path


@pytest.fixture
def copy(played: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(played, tmp_path / "run"))


def edit(path: Path, change: Callable[[Any], None]) -> None:
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))


def lines(path: Path) -> list[Any]:
    return [json.loads(line) for line in (path / "journal.jsonl").read_text().splitlines()]


def write(path: Path, records: list[Any]) -> None:
    (path / "journal.jsonl").write_text("".join(json.dumps(record) + "\n" for record in records))


@pytest.mark.parametrize(
    "change",
    [
        lambda manifest: manifest["options"].update(seed=1),
        lambda manifest: manifest["options"].update(home="planner"),
        lambda manifest: manifest["profile"].update(delay=3),
        lambda manifest: manifest["inputs"].update({__file__: content_hash(__file__)}),
    ],
)
def test_an_edited_manifest_is_refused(copy: Path, change: Callable[[Any], None]) -> None:
    edit(copy / "match.json", change)
    with pytest.raises(ConfigurationError, match=r"match.json' was edited since it was written"):
        resume_match(copy, {})
    assert any("match.json was edited" in note for note in open_source(copy).notes)


@pytest.mark.parametrize("versions", [None, {}, {"airhockey": "0.9"}, {"airhockey": "odd"}])
def test_a_seal_cannot_be_taken_away(copy: Path, versions: dict[str, str] | None) -> None:
    edit(copy / "match.json", lambda manifest: manifest["options"].update(seed=1))
    edit(copy / "match.json", lambda manifest: manifest.pop("seal"))
    if versions is not None:
        edit(copy / "match.json", lambda manifest: manifest.update(versions=versions))
    with pytest.raises(ConfigurationError, match=r"match.json' has lost its seal|began with airhockey"):
        resume_match(copy, {})
    assert any("match.json has lost its seal" in note for note in open_source(copy).notes)


def test_a_manifest_older_than_seals_is_said_to_be_so(copy: Path) -> None:
    edit(copy / "match.json", lambda manifest: manifest.pop("seal"))
    edit(copy / "match.json", lambda manifest: manifest["versions"].update(airhockey="0.0.9"))
    with pytest.raises(ConfigurationError, match=r"began with airhockey 0.0.9, but this is"):
        resume_match(copy, {})
    assert [note for note in open_source(copy).notes if "match.json was made before there were seals" in note]


def test_a_manifest_may_be_written_otherwise_and_moved(copy: Path) -> None:
    edit(copy / "match.json", lambda manifest: manifest.update(created="yesterday"))
    resume_match(Path(shutil.move(copy, copy.with_name("elsewhere"))), {}).close()


def test_a_game_that_was_edited_is_played_again(copy: Path) -> None:
    before = lines(copy)
    edited = [dict(before[0], winner="home"), before[1]]
    write(copy, edited)
    folder = resume_match(copy, {})
    assert len(folder.records) == 1
    assert "game 0 is not in its film; it is played again" in folder.notes[0]
    play_match(folder)
    assert [record["winner"] for record in lines(copy)] == [before[1]["winner"], before[0]["winner"]]


def test_lines_twice_or_in_another_order_change_nothing(copy: Path) -> None:
    before = lines(copy)
    result = json.loads((copy / "result.json").read_text())
    write(copy, [before[1], before[0], before[1]])
    played: list[Any] = []
    play_match(resume_match(copy, {}), None, played.append)
    assert not played
    assert json.loads((copy / "result.json").read_text()) == result


def test_a_game_of_another_match_is_refused(copy: Path) -> None:
    foreign = lines(copy)[0]
    foreign["job"]["key"] = "7"
    write(copy, [*lines(copy), foreign])
    with pytest.raises(ConfigurationError, match=r"no part of this run \(7\)"):
        play_match(resume_match(copy, {}))


def test_a_profile_that_was_edited_is_told(tmp_path: Path) -> None:
    profile = tmp_path / "mine.yaml"
    profile.write_text(PROFILE)
    options = Options(environments=("3dof-hit",), agent="hold", episodes=1, disturbances=str(profile))
    evaluation.begin(options, tmp_path / "run").close()

    def notes() -> list[str]:
        folder = evaluation.resume(tmp_path / "run", {})
        folder.close()
        return folder.notes

    assert notes() == []
    profile.write_text(PROFILE.replace("1", "2"))
    assert "was edited since the run" in notes()[0]
    os.unlink(profile)
    assert "cannot be read any more since the run" in notes()[0]
