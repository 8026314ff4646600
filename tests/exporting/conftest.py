"""A run and a match, small and real, made once."""

from pathlib import Path

import pytest
from games import short_match

from airhockey.evaluator import Options, begin, evaluate


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
    return short_match(tmp_path_factory.mktemp("exported") / "match")
