"""Standard streams that cannot be written: the work goes on, and files get what the screen could not."""

import contextlib
import os
import sys
from typing import Any


class Patient:
    """A text stream whose writer never hears that nobody listens: a terminal may be gone, a disk full, a letter unknown.

    Attributes:
        lost: What went wrong first; None while everything was written.
    """

    def __init__(self, stream: Any) -> None:
        self._stream = stream
        self.lost: str | None = None

    def write(self, text: str) -> int:
        """Write what can be written."""
        with self._patience():
            self._stream.write(text)
        return len(text)

    def writelines(self, lines: Any) -> None:
        """Write what can be written."""
        for line in lines:
            self.write(line)

    def flush(self) -> None:
        """Flush what can be flushed."""
        with self._patience():
            self._stream.flush()

    def isatty(self) -> bool:
        """Whether it is a terminal that is still there."""
        try:
            return bool(self._stream.isatty())
        except (OSError, ValueError):
            return False

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    @contextlib.contextmanager
    def _patience(self) -> Any:
        try:
            yield
        except BrokenPipeError:
            self.lost = self.lost or "nobody reads it"
        except OSError as error:
            self.lost = self.lost or error.strerror or str(error)
        except ValueError as error:  # it was closed
            self.lost = self.lost or str(error)


def be_patient() -> None:
    """Make both output streams such that no command stops over them."""
    for number in (0, 1, 2):  # a descriptor that is closed would be taken by the next file
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    if sys.stdout is None:
        sys.stdout = os.fdopen(1, "w", closefd=False)
    if sys.stderr is None:
        sys.stderr = os.fdopen(2, "w", closefd=False)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    if not isinstance(sys.stderr, Patient):
        sys.stderr = Patient(sys.stderr)


def leave() -> str | None:
    """Write what is left of the standard output; says what went wrong, and keeps the interpreter from saying it again."""
    try:
        sys.stdout.flush()
    except (OSError, ValueError) as error:
        silence()
        return getattr(error, "strerror", None) or str(error)
    return None


def silence() -> None:
    """Let the standard output go nowhere, or the interpreter complains as it ends."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
