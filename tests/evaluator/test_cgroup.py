"""The cgroup of an agent: the kernel counts for all its processes together, however they take what they take."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from airhockey.evaluator.isolation import cgroup
from airhockey.evaluator.isolation.cgroup import Group, new_group
from airhockey.evaluator.isolation.limits import MIB, Limits
from airhockey.evaluator.isolation.modes import protection

SHARED = """
import mmap, os, sys
sys.stdin.readline()
kept = []
for _ in range(4):
    if os.fork() == 0:
        block = mmap.mmap(-1, 48 << 20)
        block.write(b"x" * (48 << 20))
        sys.stdin.readline()
        os._exit(0)
codes = [os.wait()[1] for _ in range(4)]
print("all held" if not any(codes) else "ended", flush=True)
"""
FORKS = """
import os, sys, time
sys.stdin.readline()
born = 0
try:
    while born < 100:
        if os.fork() == 0:
            time.sleep(60)
            os._exit(0)
        born += 1
except OSError:
    pass
print(born, flush=True)
"""


def group_here(**limits: int) -> Group:
    """A group on this machine."""
    group = new_group(Limits(**limits))  # type: ignore[arg-type]
    if group is None:
        pytest.skip("this machine lets us make no cgroup")
    return group


def start(code: str, group: Group) -> "subprocess.Popen[str]":
    """A process in a group, that has done nothing yet."""
    process = subprocess.Popen(
        [sys.executable, "-c", code],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    group.add(process.pid)
    return process


def test_shared_memory_of_all_processes_counts() -> None:
    group = group_here(memory=128 * MIB)
    if "memory" not in group.limited:
        group.remove()
        pytest.skip("no cgroup limits memory here")
    process = start(SHARED, group)
    out, _ = process.communicate("\n" * 9, timeout=60)
    assert "all held" not in out and group.ran_out_of_memory()
    group.remove()


def test_processes_are_counted_and_ended_with_their_group() -> None:
    group = group_here(processes=12)
    if "processes" not in group.limited:
        group.remove()
        pytest.skip("no cgroup limits processes here")
    process = start(FORKS, group)
    assert process.stdin is not None and process.stdout is not None
    process.stdin.write("\n")
    process.stdin.flush()
    assert int(process.stdout.readline()) <= 11
    folders = list(group.folders.values())
    members = [int(pid) for pid in (folders[0] / "cgroup.procs").read_text().split()]
    group.remove()
    process.communicate(timeout=10)
    assert len(members) > 9 and process.pid in members
    assert not any(folder.exists() for folder in folders)  # the kernel removes no group with a living process


def test_version_2_limits_where_its_folder_hands_controllers_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A tree of files like the kernel's; this process's own group hands nothing on, the one above it does."""
    above, own = tmp_path / "slice", tmp_path / "slice" / "session"
    own.mkdir(parents=True)
    for folder, handed_on in ((tmp_path, ""), (above, "cpu memory pids"), (own, "")):
        (folder / "cgroup.subtree_control").write_text(handed_on)
    lines = f"40 30 0:1 / {tmp_path} rw - cgroup2 cgroup2 rw\n"
    texts = {"/proc/self/mountinfo": lines, "/proc/self/cgroup": "0::/slice/session\n"}
    read = Path.read_text
    monkeypatch.setattr(Path, "read_text", lambda self, *more: texts.get(str(self)) or read(self, *more))
    make = Path.mkdir

    def mkdir(self: Path, *given: object, **named: object) -> None:
        make(self, *given, **named)  # type: ignore[arg-type]
        (self / "cgroup.controllers").write_text("cpu memory pids")

    monkeypatch.setattr(Path, "mkdir", mkdir)
    group = new_group(Limits(memory=77, processes=5, cores=1.5))
    assert group is not None and set(group.limited) == {"memory", "processes", "cpu"}
    (folder,) = set(group.folders.values())
    assert folder.parent == above
    said = {name: read(folder / name) for name in ("memory.max", "pids.max", "cpu.max")}
    assert said == {"memory.max": "77", "pids.max": "5", "cpu.max": "150000 100000"}


def test_groups_of_killed_evaluators_are_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    left, young, alive = (tmp_path / f"airhockey-{name}" for name in ("999999999-0", "999999999-1", f"{os.getpid()}-0"))
    for folder in (left, young, alive):
        folder.mkdir()
    for folder in (left, alive):
        os.utime(folder, (0, 0))
    cgroup._remove_stale(tmp_path)
    assert (left.exists(), young.exists(), alive.exists()) == (False, True, True)


def test_what_is_not_limited_is_said() -> None:
    everything = ("memory", "processes", "cpu")
    assert protection(True, everything) == "sandbox (bubblewrap, seccomp, cgroup)"
    assert protection(True, ()).startswith(
        "sandbox (bubblewrap, seccomp, rlimits); not limited: memory of all processes"
    )
    assert "cgroup of processes" in protection(True, ("processes",))
    plain = protection(False, ("memory", "cpu"))
    assert plain == "process (cgroup); not limited: files, network, signals, number of processes within 0.1 s"
