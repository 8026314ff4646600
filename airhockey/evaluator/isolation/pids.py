"""Which processes are the agent's, by the numbers that they have out here, and what CPU time they have used."""

import json
import os
import time
from pathlib import Path


def first_inside(status: int) -> int | None:
    """The number of a sandbox's process 1, from what bubblewrap writes to `--info-fd`; None where it did not get as far."""
    text = b""
    while chunk := os.read(status, 4096):
        text += chunk
        if b"}" in chunk:
            break
    try:
        return int(json.loads(text)["child-pid"])
    except (ValueError, KeyError):
        return None


def only_child(parent: int) -> int:
    """The number of a process's only child; that of the process itself where it has none."""
    try:
        return int(Path(f"/proc/{parent}/task/{parent}/children").read_text().split()[0])
    except (OSError, IndexError):
        pass  # not every kernel has this file
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and f"\nPPid:\t{parent}\n" in (entry / "status").read_text():
                return int(entry.name)
        except OSError:
            continue
    return parent


def descendants(parent: int) -> list[int]:
    """The numbers of everything that a process has started and that still runs."""
    children: dict[int, list[int]] = {}
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            stat = (entry / "stat").read_text()
        except OSError:
            continue
        children.setdefault(int(stat.rpartition(")")[2].split()[1]), []).append(int(entry.name))
    found, level = list[int](), [parent]
    while level:
        level = [child for pid in level for child in children.get(pid, ())]
        found += level
    return found


def cpu_time(pid: int) -> float:
    """CPU time that a process has used, in [s]; 0 once it has ended."""
    try:
        return time.clock_gettime((~pid << 3) | 2)  # what clock_getcpuclockid gives
    except OSError:
        return 0.0
