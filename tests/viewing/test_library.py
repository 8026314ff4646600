"""What is found in folders: whole, half-written, damaged, foreign or hostile."""

import os
import pickle
import shutil
from pathlib import Path

import numpy as np
import pytest
from command_line import Hockey

from airhockey.errors import ConfigurationError
from airhockey.evaluator.runs import trajectories
from airhockey.evaluator.runs.game_trajectories import read_film
from airhockey.viewing.entries import Library
from airhockey.viewing.library import open_library
from airhockey.viewing.library_official import in_world
from airhockey.viewing.recording import Recording

DATASET = "official/3dof-defend/dataset.pkl"


@pytest.fixture
def run(run_folder: Path, tmp_path: Path) -> Path:
    """A copy that may be damaged."""
    return Path(shutil.copytree(run_folder, tmp_path / "copy"))


@pytest.fixture
def match(match_folder: Path, tmp_path: Path) -> Path:
    """A copy that may be damaged."""
    return Path(shutil.copytree(match_folder, tmp_path / "copy"))


def names(library: Library) -> list[str]:
    return [entry.name for entry in library.entries]


def same(one: Recording, other: Recording) -> bool:
    return np.array_equal(one.puck, other.puck) and np.array_equal(one.joints, other.joints)


def test_a_run_is_what_was_recorded(run_folder: Path) -> None:
    library = open_library(run_folder)
    assert names(library) == ["0", "1", "2"] and library.notes == []
    recording = library.entries[1].load()
    seen = trajectories.read_episode(run_folder / "trajectories.h5", "3dof-defend", 1)["observations"]
    assert recording.steps == len(seen) - 1
    assert recording.puck[:, 0] == pytest.approx(seen[:, 0] - 1.51)
    assert np.array_equal(recording.joints[:, 0], seen[:, 6:9])


def test_a_game_is_its_film(match_folder: Path) -> None:
    recording = open_library(match_folder).entries[0].load()
    film = read_film(match_folder / "films/0.h5")
    assert recording.steps == len(film) == 60
    assert np.array_equal(recording.puck, film[:, :3].astype(float))
    assert recording.joints.shape == (60, 2, 7)


def test_an_official_dataset_is_the_run(run_folder: Path) -> None:
    library, official = open_library(run_folder), open_library(run_folder / DATASET)
    assert names(official) == names(library)
    for one, other in zip(library.entries, official.entries, strict=True):
        assert same(one.load(), other.load())
    assert names(open_library(run_folder / "official")) == names(library)


def test_a_games_observations_in_the_world_are_its_film() -> None:
    from airhockey import envs

    env = envs.make("tournament")
    env.reset(seed=5)
    seen, truth = env.true_observation, env.base_observation
    rows = in_world(seen[None])[0]
    yaw = [2, 25]
    assert np.delete(rows, yaw) == pytest.approx(np.delete(truth, yaw), abs=1e-12)


class Hostile:
    """Leaves a file when it is read by an unpickler that trusts it."""

    def __reduce__(self) -> tuple[object, ...]:
        return os.mkdir, ("harmed",)


@pytest.mark.parametrize("content", [[Hostile()], [(np.zeros(12), Hostile(), 0.0, np.zeros(12), True, True)]])
def test_a_pickle_that_would_run_code_is_refused(hockey: Hockey, content: object) -> None:
    Path("dataset.pkl").write_bytes(pickle.dumps(content))
    status, _, err = hockey("replay dataset.pkl --no-browser")
    assert status == 2
    assert "posix.mkdir" in err and len(err.splitlines()) == 1
    assert not Path("harmed").exists()


@pytest.mark.parametrize("content", [b"", b"not a pickle", pickle.dumps([1, 2]), pickle.dumps({}), pickle.dumps([])])
def test_a_file_that_is_no_dataset_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "dataset.pkl").write_bytes(content)
    with pytest.raises(ConfigurationError, match=r"dataset\.pkl"):
        open_library(tmp_path / "dataset.pkl")


def test_a_dataset_out_of_its_folder_says_what_it_looks_like(run: Path) -> None:
    moved = (run / DATASET).rename(run.parent / "dataset.pkl")
    library = open_library(moved)
    assert "not known" in library.notes[0]
    assert library.entries[0].load().env.startswith("3dof")


def test_an_interrupted_run_shows_its_segments(run: Path) -> None:
    (run / "trajectories").mkdir()
    (run / "trajectories.h5").rename(run / "trajectories/000000.h5")
    (run / "trajectories/000001.h5").write_bytes(b"half of it")
    manifest = (run / "run.json").read_text()
    (run / "run.json").write_text(manifest.replace('"episodes": 3', '"episodes": 5'))
    library = open_library(run)
    assert names(library) == ["0", "1", "2"]
    notes = " ".join(library.notes)
    assert "000001.h5 cannot be read" in notes and "3 of its 5 episodes" in notes


def test_without_a_manifest_there_is_still_something_to_see(run: Path) -> None:
    (run / "run.json").unlink()
    (run / "journal.jsonl").unlink()
    library = open_library(run)
    assert names(library) == ["0", "1", "2"]
    assert "run.json" in library.notes[0]


def test_a_film_without_a_journal_brings_its_own_record(match: Path) -> None:
    (match / "journal.jsonl").unlink()
    library = open_library(match)
    assert "does not name" in library.notes[0]
    assert library.entries[0].load().narrator.caption(1).players == ("h", "a")


def test_a_game_without_a_film_is_said(match: Path) -> None:
    shutil.rmtree(match / "films")
    with pytest.raises(ConfigurationError, match="game 0 has no film"):
        open_library(match)


def test_a_film_that_is_broken_is_said(match: Path) -> None:
    (match / "films/0.h5").write_bytes(b"half of it")
    with pytest.raises(ConfigurationError, match=r"0\.h5"):
        open_library(match).entries[0].load()


@pytest.mark.parametrize("command", ["replay {} --no-browser", "video {} -o f.mp4"])
def test_a_folder_of_something_else_is_one_line(hockey: Hockey, tmp_path: Path, command: str) -> None:
    (tmp_path / "foreign").mkdir()
    (tmp_path / "foreign/holiday.jpg").write_bytes(b"")
    status, out, err = hockey(command.format(tmp_path / "foreign"))
    assert (status, out) == (2, "")
    assert "nothing to watch" in err and len(err.splitlines()) == 1


def test_an_episode_that_is_not_there_is_told_what_is(hockey: Hockey, run_folder: Path) -> None:
    status, _, err = hockey(f"replay {run_folder} --episode 9 --no-browser")
    assert status == 2
    assert "there are 0, 1, 2" in err


def nested(depth: int) -> list[object]:
    """Lists that hold the same list twice, in which whoever walks through them walks for ever."""
    inner: list[object] = [0.0]
    for _ in range(depth):
        inner = [inner, inner]
    return inner


class Asks:
    """Pickles as a call of something with a number."""

    def __init__(self, function: object, *arguments: object) -> None:
        self.call = function, arguments

    def __reduce__(self) -> object:
        return self.call


@pytest.mark.parametrize(
    "content",
    [
        Asks(bytearray, 10**12),
        Asks(bytes, 10**12),
        [(nested(60), 0, 0.0, nested(60), False, True)],
        [(np.zeros(2000), 0, 0.0, np.zeros(2000), False, True)],
        [(np.zeros((3, 3)), 0, 0.0, np.zeros((3, 3)), False, True)],
    ],
)
def test_a_dataset_that_asks_for_too_much_is_refused_at_once(tmp_path: Path, content: object) -> None:
    (tmp_path / "dataset.pkl").write_bytes(pickle.dumps(content))
    with pytest.raises(ConfigurationError, match=r"is not a dataset"):
        open_library(tmp_path / "dataset.pkl")


def test_a_dataset_that_is_too_large_is_not_read(tmp_path: Path) -> None:
    with (tmp_path / "dataset.pkl").open("wb") as file:
        file.truncate(5 << 30)  # nothing is written
    with pytest.raises(ConfigurationError, match="are allowed"):
        open_library(tmp_path / "dataset.pkl")
