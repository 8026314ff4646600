"""A cgroup for one agent, where this machine lets us make one: the kernel then counts for all its processes together.

What they hold counts whichever way they took it: memory of their own, shared, of files in memory. Version 2 of cgroups and
version 1 are known. Where no cgroup can be made, there are the limits of each process and the watch over their sum.
"""

import contextlib
import itertools
import os
import secrets
import signal
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from airhockey.evaluator.isolation.limits import Limits

_PREFIX = "airhockey-"
_STALE = 60.0  # [s], after which an empty group of a process that is gone is removed
_PERIOD = 100_000  # [µs] of the CPU's quota


@dataclass
class Group:
    """The cgroup of one agent, in one folder (version 2) or one for each resource (version 1).

    Attributes:
        folders: Resource, "memory", "processes" or "cpu" -> the folder that limits it.
    """

    folders: dict[str, Path] = field(default_factory=dict)

    @property
    def limited(self) -> tuple[str, ...]:
        """What the kernel limits for all processes together."""
        return tuple(self.folders)

    def add(self, pid: int) -> None:
        """Take a process in, with all that it will ever start; raises `OSError` where that may not be."""
        for folder in dict.fromkeys(self.folders.values()):
            (folder / "cgroup.procs").write_text(str(pid))

    def ran_out_of_memory(self) -> bool:
        """Whether the kernel had to end a process because the limit was reached."""
        if "memory" not in self.folders:
            return False
        lines = [_words(self.folders["memory"] / name) for name in ("memory.events", "memory.oom_control")]
        return any(name == "oom_kill" and count != "0" for words in lines for name, count in itertools.pairwise(words))

    def remove(self) -> None:
        """End every process in it, and the group itself; what still dies is left to `_remove_stale`."""
        for folder in dict.fromkeys(self.folders.values()):
            with contextlib.suppress(OSError, ValueError):
                for pid in (folder / "cgroup.procs").read_text().split():
                    os.kill(int(pid), signal.SIGKILL)
            for _ in range(50):
                try:
                    folder.rmdir()
                except FileNotFoundError:
                    break
                except OSError:
                    time.sleep(0.002)  # its last process is not gone yet
                else:
                    break
        self.folders = {}


def new_group(limits: Limits, count_processes: bool = True) -> Group | None:
    """A group with an agent's limits; None where this machine lets us make none.

    Args:
        limits: The agent's.
        count_processes: Also limit their number, as `Limits.apply`.
    """
    name = f"{_PREFIX}{os.getpid()}-{secrets.token_hex(4)}"  # containers may share folders, and count from 1
    group = Group()
    for resource, parents in _parents().items():
        if resource == "processes" and not count_processes:
            continue
        for parent in parents:
            folder = parent / name
            try:
                folder.mkdir(exist_ok=True)
                _limit(folder, resource, limits)
            except OSError:
                if folder not in group.folders.values():
                    with contextlib.suppress(OSError):
                        folder.rmdir()
                continue
            group.folders[resource] = folder
            break
    return group if group.folders else None


def _limit(folder: Path, resource: str, limits: Limits) -> None:
    """Write the limits of one resource; raises `OSError` where the folder has no such controller."""
    new = (folder / "cgroup.controllers").exists()
    if resource == "memory":
        (folder / ("memory.max" if new else "memory.limit_in_bytes")).write_text(str(limits.memory))
        for more, value in (
            ("memory.swap.max", 0),
            ("memory.oom.group", 1),
            ("memory.memsw.limit_in_bytes", limits.memory),
        ):
            with contextlib.suppress(OSError):  # not every kernel counts swap
                if (folder / more).exists():
                    (folder / more).write_text(str(value))
    elif resource == "processes":
        (folder / "pids.max").write_text(str(limits.processes))
    elif new:
        (folder / "cpu.max").write_text(f"{int(limits.cores * _PERIOD)} {_PERIOD}")
    else:
        (folder / "cpu.cfs_period_us").write_text(str(_PERIOD))
        (folder / "cpu.cfs_quota_us").write_text(str(int(limits.cores * _PERIOD)))


def _parents() -> dict[str, list[Path]]:
    """Resource -> folders in which a group that limits it might be made, the best first."""
    found: dict[str, list[Path]] = {}
    for controllers, place in _own_places():
        for controller, resource in (("memory", "memory"), ("pids", "processes"), ("cpu", "cpu")):
            if controller in controllers:
                found.setdefault(resource, []).extend(place)
    for parent in {place for places in found.values() for place in places}:
        _remove_stale(parent)
    return found


def _own_places() -> Iterator[tuple[tuple[str, ...], list[Path]]]:
    """The controllers of each hierarchy, with this process's folder in it; for version 2 also those above, which hold others."""
    mounts = list(_mounts())
    with contextlib.suppress(OSError):
        for line in Path("/proc/self/cgroup").read_text().splitlines():
            number, names, path = line.split(":", 2)
            for kind, options, root, mounted in mounts:
                if not f"{path}/".startswith(f"{root.rstrip('/')}/"):
                    continue
                own = Path(mounted) / path[len(root.rstrip("/")) :].lstrip("/")
                if number == "0" and kind == "cgroup2":
                    yield ("memory", "pids", "cpu"), _that_hand_on([own, *own.parents], Path(mounted))
                elif kind == "cgroup" and names and set(names.split(",")) <= set(options.split(",")):
                    yield tuple(names.split(",")), [own]


def _that_hand_on(folders: list[Path], top: Path) -> list[Path]:
    """Those of version 2 whose groups have controllers."""
    return [
        folder
        for folder in folders
        if folder.is_relative_to(top)
        and "memory" in _words(folder / "cgroup.subtree_control")
        and os.access(folder, os.W_OK)
    ]


def _words(file: Path) -> list[str]:
    try:
        return file.read_text().split()
    except OSError:
        return []


def _mounts() -> Iterator[tuple[str, str, str, str]]:
    """Kind, options, root and place of every mounted hierarchy of cgroups."""
    with contextlib.suppress(OSError):
        for line in Path("/proc/self/mountinfo").read_text().splitlines():
            before, _, after = line.partition(" - ")
            fields, (kind, _, options) = before.split(), after.split()[:3]
            if kind in ("cgroup", "cgroup2"):
                yield kind, options, fields[3], fields[4]


def _remove_stale(parent: Path) -> None:
    """Remove groups that killed evaluators have left."""
    with contextlib.suppress(OSError):
        for folder in parent.glob(f"{_PREFIX}*"):
            owner = folder.name[len(_PREFIX) :].partition("-")[0]
            with contextlib.suppress(OSError):
                if not Path(f"/proc/{owner}").exists() and time.time() - folder.stat().st_mtime > _STALE:
                    folder.rmdir()
