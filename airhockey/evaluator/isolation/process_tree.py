"""An agent's process and everything that it starts: who there is, how much CPU time and memory they take together."""

import contextlib
import os
import time
from pathlib import Path

_PROC = Path("/proc")
_PAGE = os.sysconf("SC_PAGE_SIZE")
_HAS_CHILDREN_FILES = Path(f"/proc/self/task/{os.getpid()}/children").exists()


class ProcessTree:
    """The processes of one agent.

    Args:
        agent: Number of the process that answers.
        top: Number of the process above it, of which all others descend: process 1 of a sandbox; default: the agent itself.

    Attributes:
        agent, top: As given.
        others: The agent's other processes, as they were last seen.
        had_others: Whether there ever were any.
    """

    def __init__(self, agent: int, top: int | None = None) -> None:
        self.agent, self.had_others = agent, False
        self.others: tuple[int, ...] = ()
        self.top = agent if top is None else top
        self._used: dict[int, float] = {}
        self._gone = 0.0

    def look(self) -> tuple[int, ...]:
        """See which other processes there are now."""
        found = tuple(pid for pid in descendants(self.top) if pid != self.agent)
        self.others = found
        self.had_others = self.had_others or bool(found)
        return found

    def cpu_time(self) -> float:
        """CPU time of the agent and of the others that were seen, those that have ended included, in [s]."""
        total = cpu_time_of(self.agent) + self._gone
        if not self.had_others:
            return total
        for pid in {*self.others, *self._used}:
            used = cpu_time_of(pid)
            if used > 0.0:
                self._used[pid] = used
                total += used
            else:
                before = self._used.pop(pid, 0.0)
                self._gone += before
                total += before
        return total

    def waited(self) -> float:
        """How long they were ready to run and the machine had no core for them, in [s]; 0 where the kernel does not say."""
        return sum(map(_queued, (self.agent, *self.others)))

    def memory(self) -> int:
        """Memory that all of them hold together, in bytes; what they share counts once, where it matters."""
        everybody = (self.agent, *self.others)
        return sum(map(_resident, everybody))

    def shared_memory_apart(self) -> int:
        """As `memory`, but a page that several hold counts in shares. Slow where there is much of it."""
        return sum(map(_proportional, (self.agent, *self.others)))


def descendants(pid: int) -> list[int]:
    """Every living process below a process, in no order."""
    found: list[int] = []
    below = _children_by_files if _HAS_CHILDREN_FILES else _Snapshot()
    new = [pid]
    while new:
        new = [child for parent in new for child in below(parent)]
        found += new
    return found


def cpu_time_of(pid: int) -> float:
    """CPU time of a process and all its threads, in [s]; 0 once it has ended."""
    try:
        return time.clock_gettime((~pid << 3) | 2)  # what clock_getcpuclockid gives
    except OSError:
        return 0.0


def _children_by_files(pid: int) -> list[int]:
    """Children of every thread of a process."""
    children: list[int] = []
    with contextlib.suppress(OSError):
        for thread in os.listdir(f"/proc/{pid}/task"):
            with contextlib.suppress(OSError), open(f"/proc/{pid}/task/{thread}/children") as file:
                children += map(int, file.read().split())
    return children


class _Snapshot:
    """Children by looking at every process of the machine once."""

    def __init__(self) -> None:
        self._children: dict[int, list[int]] = {}
        for entry in os.listdir(_PROC):
            if entry.isdigit():
                with contextlib.suppress(OSError, IndexError, ValueError):
                    parent = int((_PROC / entry / "stat").read_text().rpartition(") ")[2].split()[1])
                    self._children.setdefault(parent, []).append(int(entry))

    def __call__(self, pid: int) -> list[int]:
        return self._children.get(pid, [])


def _queued(pid: int) -> float:
    with contextlib.suppress(OSError, IndexError, ValueError), open(f"/proc/{pid}/schedstat") as file:
        return int(file.read().split()[1]) * 1e-9
    return 0.0


def _resident(pid: int) -> int:
    with contextlib.suppress(OSError, IndexError, ValueError), open(f"/proc/{pid}/statm") as file:
        return int(file.read().split()[1]) * _PAGE
    return 0


def _proportional(pid: int) -> int:
    try:
        with open(f"/proc/{pid}/smaps_rollup") as file:
            return next(int(line.split()[1]) << 10 for line in file if line.startswith("Pss:"))
    except (OSError, StopIteration, ValueError):
        return _resident(pid)
