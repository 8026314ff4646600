"""Films: as long as what was played, moving, complete or not there; and what is said when there can be none."""

import sys
from pathlib import Path

import av
import numpy as np
import pytest
from command_line import Hockey
from PIL import Image

from airhockey.envs.rendering import offscreen
from airhockey.errors import MissingDependencyError
from airhockey.evaluator.runs.journal import read_journal
from airhockey.evaluator.runs.records import EpisodeRecord
from airhockey.viewing.video_writer import open_video

SMALL = "--size 160x96 --quality fast --quiet"
STEP = 0.02


def frames(path: Path) -> list[np.ndarray]:
    with av.open(str(path)) as film:
        return [frame.to_ndarray(format="rgb24").astype(int) for frame in film.decode(video=0)]


@pytest.mark.usefixtures("rendering")
def test_a_film_of_episodes_is_as_long_as_they_were_and_moves(hockey: Hockey, run_folder: Path) -> None:
    status, out, err = hockey(f"video {run_folder} -o f.mp4 --episodes 2,0 {SMALL}")
    assert status == 0, err
    steps = {record.index: record.steps for record in read_journal(run_folder, EpisodeRecord).records}
    seen = frames(Path("f.mp4"))
    assert len(seen) == round(steps[2] * STEP * 25) + round(steps[0] * STEP * 25)
    assert seen[0].shape == (96, 160, 3)
    middle = slice(20, 80)  # without the captions
    assert np.abs(seen[0][middle] - seen[len(seen) // 3][middle]).max() > 60, "the puck has not moved"
    assert [path.name for path in Path().iterdir()] == ["f.mp4"], "nothing half-written is left"
    assert f"{len(seen)} frames" in out


@pytest.mark.usefixtures("rendering")
@pytest.mark.parametrize(("options", "fps", "speed"), [("--fps 50", 50, 1), ("--speed 3", 25, 3)])
def test_a_film_of_a_game_has_the_games_length(
    hockey: Hockey, match_folder: Path, options: str, fps: int, speed: int
) -> None:
    assert hockey(f"video {match_folder} -o game.mp4 {options} {SMALL}")[0] == 0
    seen = frames(Path("game.mp4"))
    assert len(seen) == 60 * STEP * fps / speed


@pytest.mark.usefixtures("rendering")
def test_a_gif_keeps_time(hockey: Hockey, match_folder: Path) -> None:
    assert hockey(f"video {match_folder} -o game.gif --fps 30 {SMALL} --no-inset")[0] == 0
    with Image.open("game.gif") as film:
        durations = []
        for k in range(film.n_frames):
            film.seek(k)
            durations.append(film.info["duration"])
    assert film.size == (160, 96)
    assert sum(durations) == pytest.approx(60 * STEP * 1000, abs=10)


@pytest.mark.usefixtures("rendering")
def test_highlights_of_episodes_are_what_led_to_a_success(hockey: Hockey, run_folder: Path) -> None:
    assert [record.success for record in read_journal(run_folder, EpisodeRecord).records] == [False, False, True]
    assert hockey(f"video {run_folder} -o f.mp4 --highlights {SMALL}")[0] == 0
    assert len(frames(Path("f.mp4"))) == 2 * 25, "the two seconds before the puck was stopped"
    assert hockey(f"video {run_folder} -o g.mp4 --highlights --episodes 0 {SMALL}")[0] == 2


@pytest.mark.usefixtures("rendering")
def test_the_beginning_of_every_episode(hockey: Hockey, run_folder: Path) -> None:
    assert hockey(f"video {run_folder} -o f.mp4 --seconds 0.4 {SMALL}")[0] == 0
    assert len(frames(Path("f.mp4"))) == 3 * 10


@pytest.mark.usefixtures("rendering")
def test_a_still_is_the_moment_asked_for(hockey: Hockey, match_folder: Path) -> None:
    assert hockey(f"video {match_folder} -o a.png --at 0.5 {SMALL}")[0] == 0
    assert hockey(f"video {match_folder} -o b.png --at 0.54 {SMALL}")[0] == 0
    one, other = (np.asarray(Image.open(name)).astype(int) for name in ("a.png", "b.png"))
    assert one.shape == (96, 160, 3)
    clock = one[:8, 120:] - other[:8, 120:]
    assert np.abs(clock).max() == 0, "0.5 and 0.54 are the same tenth"
    assert hockey(f"video {match_folder} -o a.png {SMALL}")[0] == 2
    assert hockey(f"video {match_folder} -o a.mp4 --at 1 {SMALL}")[0] == 2


@pytest.mark.usefixtures("rendering")
def test_a_gif_that_nobody_could_load_is_refused(hockey: Hockey, run_folder: Path) -> None:
    status, _, err = hockey(f"video {run_folder} -o f.gif --speed 0.02 --fps 50 {SMALL}")
    assert status == 2 and "GIF of more than" in err
    assert not list(Path().iterdir())


def test_a_film_that_fails_is_not_there(tmp_path: Path) -> None:
    (tmp_path / "f.mp4").write_bytes(b"the old one")

    def fail() -> None:
        with open_video(tmp_path / "f.mp4", 64, 48, 25) as film:
            film.add(np.zeros((48, 64, 3), dtype=np.uint8))
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert (tmp_path / "f.mp4").read_bytes() == b"the old one"
    assert len(list(tmp_path.iterdir())) == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("{run} -o f.avi", ".avi"),
        ("{run} -o nowhere/f.mp4", "nowhere"),
        ("{run} -o f.mp4 --size 161x96", "even"),
        ("{run} -o f.mp4 --size 9x9", "960x540"),
        ("{run} -o f.mp4 --episodes 0,7", "there are 0, 1, 2"),
        ("nothing-here -o f.mp4", "nothing-here"),
    ],
)
def test_what_cannot_be_filmed_is_said_in_one_line(
    hockey: Hockey, run_folder: Path, match_folder: Path, arguments: str, words: str
) -> None:
    status, _, err = hockey(f"video {arguments.format(run=run_folder, match=match_folder)}")
    assert status == 2
    assert words in err and len(err.splitlines()) == 1
    assert not list(Path().iterdir())


@pytest.mark.usefixtures("rendering")
def test_a_game_without_highlights_is_said_to_have_none(hockey: Hockey, match_folder: Path) -> None:
    status, _, err = hockey(f"video {match_folder} -o f.mp4 --highlights --size 64x48 --quiet")
    assert status == 2
    assert "highlights" in err and len(err.splitlines()) == 1
    assert not list(Path().iterdir())


def test_without_the_extra_the_command_that_installs_it_is_named(
    hockey: Hockey, run_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "av", None)
    status, _, err = hockey(f"video {run_folder} -o f.mp4")
    assert status == 2
    assert "pip install 'airhockey[video]'" in err


@pytest.mark.parametrize(
    "failure", ["raise AttributeError('no glGetError')", "raise OSError('libEGL.so.1')", "exit(3)"]
)
def test_a_machine_that_cannot_render_is_told_what_to_install(monkeypatch: pytest.MonkeyPatch, failure: str) -> None:
    """Whatever ends a backend's trial, and wherever: as its library is loaded, or later."""
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(offscreen, "_TRIAL", failure)
    with pytest.raises(MissingDependencyError, match="libegl1 libgl1 libosmesa6") as error:
        offscreen.choose_backend()
    expected = "ended with status 3" if "exit" in failure else failure[6:].replace("('", ": ").rstrip("')")
    assert f"egl: {expected}; osmesa: {expected}" in str(error.value)


@pytest.mark.parametrize("backend", ["egl", "osmesa"])
def test_a_backend_without_its_library_is_not_there(
    backend: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """PyOpenGL then fails in ways of its own: with an AttributeError while it is imported."""
    package = tmp_path / "OpenGL"
    package.mkdir()
    (package / "__init__.py").write_text("None.glGetError")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    why = offscreen.why_not(backend)
    assert why is not None and "AttributeError" in why
