"""Small agents as submission folders, and short runs of them."""

import signal
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from outcomes import ENV

from airhockey.evaluator import Options
from submissions import make_submission

# A shell that starts the tests in the background has them ignore Ctrl-C, which some of them send.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def submission(tmp_path: Path) -> Callable[..., str]:
    """Makes the folder of an agent, see `make_submission`."""
    return partial(make_submission, tmp_path)


@pytest.fixture
def options(submission: Callable[..., str]) -> Options:
    """A short run of an agent that draws from NumPy's global generator, under disturbances."""
    return Options(environments=(ENV,), agent=submission(), episodes=6, seed=3, disturbances="server")
