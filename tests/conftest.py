"""Small agents as submission folders, and short runs of them."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from outcomes import ENV

from airhockey.evaluator import Options
from submissions import make_submission


@pytest.fixture
def submission(tmp_path: Path) -> Callable[..., str]:
    """Makes the folder of an agent, see `make_submission`."""
    return partial(make_submission, tmp_path)


@pytest.fixture
def options(submission: Callable[..., str]) -> Options:
    """A short run of an agent that draws from NumPy's global generator, under disturbances."""
    return Options(environments=(ENV,), agent=submission(), episodes=6, seed=3, disturbances="server")
