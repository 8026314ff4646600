"""What an agent's processes take together, seen from outside."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Any

import pytest

from airhockey.evaluator.isolation import process_tree
from airhockey.evaluator.isolation.memory_watch import Watched, forget, watch
from airhockey.evaluator.isolation.process_tree import ProcessTree, cpu_time_of, descendants

FAMILY = """
import os, sys, threading, time
def below():
    if os.fork() == 0:
        if os.fork() == 0:
            end = time.process_time() + {work}
            block = bytearray(b"x" * {memory})
            while time.process_time() < end: pass
            print("worked", flush=True)
        time.sleep(60)
threading.Thread(target=below).start()
time.sleep(60)
"""


@pytest.fixture
def family(request: pytest.FixtureRequest) -> Iterator[Any]:
    """A process whose thread has a child, which has a child that works."""
    work, memory = getattr(request, "param", (0.2, 1))
    process = subprocess.Popen(
        [sys.executable, "-c", FAMILY.format(work=work, memory=memory)], stdout=subprocess.PIPE, start_new_session=True
    )
    yield process
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@pytest.mark.parametrize("has_files", [True, False])
def test_everybody_below_is_found(family: Any, has_files: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if has_files and not process_tree._HAS_CHILDREN_FILES:
        pytest.skip("this kernel has no such files")
    monkeypatch.setattr(process_tree, "_HAS_CHILDREN_FILES", has_files)
    family.stdout.readline()
    assert len(descendants(family.pid)) == 2


def test_their_cpu_time_is_summed_and_kept_when_they_end(family: Any) -> None:
    tree = ProcessTree(family.pid)
    family.stdout.readline()
    assert tree.cpu_time() < 0.2  # nobody has looked for others yet
    tree.look()
    both = tree.cpu_time()
    assert both >= 0.2 and both == pytest.approx(sum(map(cpu_time_of, (family.pid, *tree.others))), abs=0.01)
    for pid in tree.others:
        os.kill(pid, signal.SIGKILL)
    time.sleep(0.1)
    assert tree.cpu_time() == pytest.approx(both, abs=0.02)
    tree.look()
    assert tree.had_others and tree.cpu_time() == pytest.approx(both, abs=0.02)


@pytest.mark.parametrize("family", [(0.0, 150 << 20)], indirect=True)
def test_who_holds_too_much_together_is_ended(family: Any) -> None:
    family.stdout.readline()
    modest, greedy = Watched(ProcessTree(family.pid), 1 << 30, 9), Watched(ProcessTree(family.pid), 100 << 20, 9)
    watch(modest)
    time.sleep(0.4)
    assert family.poll() is None and modest.excess is None and len(modest.tree.others) == 2
    watch(greedy)
    assert family.wait(10.0) == -signal.SIGKILL
    assert greedy.excess == "its processes together took more than 100 MiB of memory"
    forget(modest)
    forget(greedy)


def test_who_has_too_many_processes_is_ended(family: Any) -> None:
    family.stdout.readline()
    many = Watched(ProcessTree(family.pid), 1 << 30, 2)
    watch(many)
    assert family.wait(10.0) == -signal.SIGKILL
    assert many.excess == "it had more than 2 processes"
    forget(many)


def test_a_process_that_has_ended_uses_nothing() -> None:
    process = subprocess.Popen(["true"])
    process.wait()
    tree = ProcessTree(process.pid)
    assert (tree.look(), tree.cpu_time(), tree.memory(), tree.waited()) == ((), 0.0, 0, 0.0)
