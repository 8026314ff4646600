"""One thread that looks at all isolated agents, ten times a second: who has other processes, who has too many or takes too
much memory.

Where the kernel counts for us (cgroups) it stops them at once; this watch is there for every other machine: an agent's processes
are ended when together they hold more than the limit.
"""

import contextlib
import os
import signal
import threading
import time
import weakref
from collections.abc import Sequence

from airhockey.evaluator.isolation.process_tree import ProcessTree

PERIOD = 0.1  # [s] between two looks
_FILES = 20_000
_SOCKETS = 128


class Watched:
    """An agent under watch.

    Args:
        tree: Its processes.
        memory: What they may hold together, in bytes.
        processes: How many there may be.
        scratch: Its folders in memory, as this process finds them.

    Attributes:
        waited: For how long they had been kept waiting for a core when they were last looked at, in [s].
        excess: What they were ended for; None while they keep within the limit.
    """

    def __init__(self, tree: ProcessTree, memory: int, processes: int, scratch: Sequence[str] = ()) -> None:
        self.tree, self._memory, self._processes, self._scratch = tree, memory, processes, scratch
        self.waited = 0.0
        self.excess: str | None = None

    def look(self) -> None:
        """See who there is, and end all where they are too many or hold too much."""
        self.tree.look()
        self.waited = self.tree.waited()
        if len(self.tree.others) >= self._processes:
            self._end(f"it had more than {self._processes} processes")
        elif self.tree.memory() > self._memory and self.tree.shared_memory_apart() > self._memory:
            self._end(f"its processes together took more than {self._memory >> 20} MiB of memory")
        elif any(map(_has_too_many_files, self._scratch)):
            self._end(f"it had more than {_FILES:,} files")
        elif self._scratch and sockets_of(self.tree.agent) > _SOCKETS:
            self._end(f"it had more than {_SOCKETS} sockets of a network that it does not have")

    def _end(self, excess: str) -> None:
        self.excess = excess
        for pid in (self.tree.top, self.tree.agent, *self.tree.others):  # with a sandbox's first all others end
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGKILL)


def _has_too_many_files(folder: str) -> bool:
    """Whether a folder in memory holds more files than anybody needs; each takes a kilobyte of the kernel."""
    try:
        there = os.statvfs(folder)
    except OSError:
        return False
    return there.f_files - there.f_ffree > _FILES


def sockets_of(pid: int) -> int:
    """How many sockets of a network there are in a process's namespace.

    What waits in connections to itself is memory of the kernel's, of which all of the machine has one share.
    """
    found = 0
    for name in ("sockstat", "sockstat6"):
        with contextlib.suppress(OSError), open(f"/proc/{pid}/net/{name}") as file:
            for kind, what, number, *_ in (line.split() for line in file if line.count(" ") > 1):
                found += int(number) if what == "inuse" and kind.startswith(("TCP", "UDP", "RAW")) else 0
    return found


_all: "weakref.WeakSet[Watched]" = weakref.WeakSet()
_lock = threading.RLock()  # a collection in the midst of a look may close an agent, and forget it
_thread: threading.Thread | None = None


def watch(agent: Watched) -> None:
    """Look at an agent until nobody else knows it any more, or `forget` is called."""
    global _thread
    begun: threading.Thread | None = None
    with _lock:
        _all.add(agent)
        ended = _thread is not None and _thread.ident is not None and not _thread.is_alive()  # after a fork
        if _thread is None or ended:
            begun = _thread = threading.Thread(target=_look_at_all, name="memory watch", daemon=True)
    if begun is not None:
        # Without the lock: a collection in the new thread may close an agent and forget it before it says that it runs.
        begun.start()


def forget(agent: Watched) -> None:
    """Look at an agent no longer: its number may soon be another's."""
    with _lock:
        _all.discard(agent)


def _look_at_all() -> None:
    global _thread
    while True:
        time.sleep(PERIOD)
        with _lock:
            if not _all:
                _thread = None
                return
            for agent in list(_all):
                with contextlib.suppress(OSError):
                    agent.look()
