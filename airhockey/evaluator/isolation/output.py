"""What an isolated agent prints: shown on the standard error up to a point, kept in part, and never in anybody's way."""

import contextlib
import os
import select
import sys

from airhockey.inputs.names import shown

_TAIL = 4096
"""How much of the end is kept, in bytes."""
_SHOWN = 1 << 16
"""How much of one agent is shown by this process, however often it is built again, in bytes."""
_LAST_READS = 64
"""How often the pipe is read once the agent has ended; children of its may print for ever."""


_left: dict[str, int] = {}


class Output:
    """The reading end of the pipe that an agent's standard output and error are.

    Args:
        descriptor: Of the pipe.
        name: The agent's.

    Attributes:
        descriptor: Of the pipe; -1 once it is closed.
    """

    def __init__(self, descriptor: int, name: str) -> None:
        os.set_blocking(descriptor, False)
        self.descriptor = descriptor
        self._tail = b""
        self._name = name

    @property
    def tail(self) -> str:
        """The end of what was printed."""
        self.drain()
        return self._tail.decode("utf-8", "replace")

    def drain(self) -> bool:
        """Take what is there, so that the agent can print more; False at the end of it."""
        if self.descriptor < 0:
            return False
        with contextlib.suppress(BlockingIOError):
            chunk = os.read(self.descriptor, 1 << 16)
            self._tail = (self._tail + chunk)[-_TAIL:]
            self._show(chunk)
            return bool(chunk)
        return True

    def drain_all(self) -> None:
        """Take everything that is left, within reason."""
        for _ in range(_LAST_READS):
            if not (self.drain() and select.select([self.descriptor], [], [], 0)[0]):
                break

    def close(self) -> None:
        """Take what is left, and close the pipe."""
        if self.descriptor >= 0:
            self.drain_all()
            os.close(self.descriptor)
            self.descriptor = -1

    def _show(self, chunk: bytes) -> None:
        """On our standard error; control sequences could do things to a terminal."""
        left = _left.get(self._name, _SHOWN)
        if left <= 0 or not chunk:
            return
        text = shown(chunk[:left].decode("utf-8", "replace"), 8 * _SHOWN, keep="\n\t")
        _left[self._name] = left - len(chunk)
        more = "" if left > len(chunk) else "\n(what this agent prints is not shown any more)\n"
        with contextlib.suppress(OSError, ValueError):
            sys.stderr.write(text + more)
