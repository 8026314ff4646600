"""Small real results to look at, made once: episodes of a task, and a game."""

from pathlib import Path

import pytest
from games import short_match
from tools import needs_rendering

from airhockey.evaluator import Options, begin, evaluate
from airhockey.evaluator.official import write_official


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
    return short_match(tmp_path_factory.mktemp("results") / "match")


@pytest.fixture
def rendering() -> None:
    """Skips where nothing can be rendered."""
    needs_rendering()
