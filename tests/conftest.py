"""Small agents as submission folders, short runs of them, and the command line in an empty folder."""

import os
import signal
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from command_line import Hockey
from outcomes import ENV

from airhockey.cli import main
from airhockey.evaluator import Options
from submissions import make_submission

# A shell that starts the tests in the background has them ignore Ctrl-C, which some of them send.
signal.signal(signal.SIGINT, signal.default_int_handler)


EXPENSIVE = {
    "results": "reporting", "here": "participants", "zoo": "participants", "served": "viewer",
    "finished": None, "straight": None, "site": None,
}  # fmt: skip
"""Fixtures that take many seconds -> the group of tests that shares them; None: of its module."""


@pytest.hookimpl(tryfirst=True)  # before xdist reads the groups
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests that share an expensive fixture run in one process, so that it is made once (`--dist loadgroup`).

    What takes many seconds waits for `make long`, which runs everything; `make test` keeps a shorter one of its kind, and of
    many cases that are `sampled(n)` every n-th.
    """
    for item in items:
        for name in EXPENSIVE.keys() & set(getattr(item, "fixturenames", ())):
            item.add_marker(pytest.mark.xdist_group(EXPENSIVE[name] or item.path.stem))
    if "LONG" in os.environ:
        return
    skip = pytest.mark.skip(reason="takes many seconds: make long")
    cases: Counter[str] = Counter()
    for item in items:
        sampled = item.get_closest_marker("sampled")
        if sampled is not None:
            name = item.nodeid.partition("[")[0]
            cases[name] += 1
        if item.get_closest_marker("long") is not None or (sampled and (cases[name] - 1) % sampled.args[0]):
            item.add_marker(skip)


@pytest.fixture
def submission(tmp_path: Path) -> Callable[..., str]:
    """Makes the folder of an agent, see `make_submission`."""
    return partial(make_submission, tmp_path)


@pytest.fixture
def options(submission: Callable[..., str]) -> Options:
    """A short run of an agent that draws from NumPy's global generator, under disturbances."""
    return Options(environments=(ENV,), agent=submission(), episodes=6, seed=3, disturbances="server")


@pytest.fixture
def hockey(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Hockey:
    """Runs a command line in an empty folder; gives status, standard output and standard error."""
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")

    def run(line: str) -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as end:
            main(line.split())
        out, err = capfd.readouterr()
        return int(end.value.code or 0), out, err

    return run
