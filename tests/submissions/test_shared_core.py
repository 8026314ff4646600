"""An agent's process runs where its evaluator does."""

import os
import subprocess
import sys
from collections.abc import Iterator

import pytest

from airhockey.evaluator.isolation.shared_core import SharedCore


@pytest.fixture
def process() -> Iterator[subprocess.Popen[bytes]]:
    child = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    yield child
    child.kill()
    child.wait()


@pytest.fixture
def cores() -> Iterator[list[int]]:
    allowed = os.sched_getaffinity(0)
    yield sorted(allowed)
    os.sched_setaffinity(0, allowed)


def test_it_follows_the_evaluator_from_core_to_core(process: subprocess.Popen[bytes], cores: list[int]) -> None:
    shared = SharedCore(process.pid)
    for core in (*cores, cores[0]):
        os.sched_setaffinity(0, {core})
        shared.follow()
        assert os.sched_getaffinity(process.pid) == {core}


def test_a_process_that_has_ended_is_no_error(process: subprocess.Popen[bytes]) -> None:
    process.kill()
    process.wait()
    SharedCore(process.pid).follow()
