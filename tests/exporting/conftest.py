"""A run and a match, small and real, made once."""

from pathlib import Path

import pytest
from games import play_one

from airhockey.envs.disturbances import load_disturbances
from airhockey.evaluator import Options, begin, evaluate
from airhockey.evaluator.match import MatchFolder, MatchOptions
from airhockey.evaluator.runs.game_records import GameOptions
from airhockey.evaluator.runs.manifest import Manifest

GAME_STEPS = 60


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Episodes of two environments under disturbances."""
    path = tmp_path_factory.mktemp("exported") / "run"
    options = Options(environments=("3dof-hit", "7dof-hit"), agent="hold", episodes=3, seed=4, disturbances="server")
    evaluate(begin(options, path))
    return path


@pytest.fixture(scope="module")
def match(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A game of a little over a second."""
    path = tmp_path_factory.mktemp("exported") / "match"
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
