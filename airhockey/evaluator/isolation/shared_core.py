"""An agent's process on the core on which its evaluator runs.

The two take turns, so nothing is lost by sharing a core, and much is won: to wake a process on another core, which has fallen
asleep meanwhile, costs 50 to 100 µs each way, a switch on the same one about 5.
"""

import contextlib
import ctypes
import os

_libc = ctypes.CDLL(None)


class SharedCore:
    """Keeps the main thread of a process on the caller's core; its other threads run where they like.

    Args:
        pid: Of the process.
    """

    def __init__(self, pid: int) -> None:
        self._pid, self._core = pid, -1

    def follow(self) -> None:
        """Let the process run where the caller runs now; without the right to say so it stays where it is."""
        core = _libc.sched_getcpu()
        if core != self._core and core >= 0:
            self._core = core
            with contextlib.suppress(OSError):
                os.sched_setaffinity(self._pid, (core,))
