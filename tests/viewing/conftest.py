"""Small real results to look at, made once: episodes of a task, and a game."""

from pathlib import Path

import pytest
from games import play_one
from tools import needs_rendering

from airhockey.envs.disturbances import load_disturbances
from airhockey.evaluator import Options, begin, evaluate
from airhockey.evaluator.match import MatchFolder, MatchOptions
from airhockey.evaluator.official import write_official
from airhockey.evaluator.runs.game_records import GameOptions
from airhockey.evaluator.runs.manifest import Manifest

GAME_STEPS = 60


@pytest.fixture(scope="session")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three episodes of 3dof-defend by an agent that stands still, with the official files."""
    path = tmp_path_factory.mktemp("results") / "run"
    options = Options(environments=("3dof-defend",), agent="hold", episodes=3, seed=4)
    write_official(path, evaluate(begin(options, path)))
    return path


@pytest.fixture(scope="session")
def match_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A game of a little over a second."""
    path = tmp_path_factory.mktemp("results") / "match"
    rules = GameOptions(steps=GAME_STEPS)
    manifest = Manifest(
        options=MatchOptions(home="h", away="a", game=rules),
        profile=load_disturbances("ideal"),
        versions={},
        created="",
    )
    with MatchFolder.create(path, manifest) as folder:
        folder.add(play_one("hold", "hold", GAME_STEPS))
    return path


@pytest.fixture
def rendering() -> None:
    """Skips where nothing can be rendered."""
    needs_rendering()
