"""Who is at work: so that a call that never returns can be ended, and a process that dies tells over whom.

    live/KEY      one byte: "0" or "1", whose code is running, or "-"; then the game's status as JSON

The file is mapped into memory: what was written last survives the process, and costs no more than an assignment.
"""

import contextlib
import ctypes
import mmap
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final, Self

import msgspec

from airhockey.envs.copying import NotCopyable
from airhockey.evaluator.runs.game_records import AWAY, HOME, Side, Status

PATIENCE = 300.0
"""Longest time that any call of an agent may take, in [s], before the agent has failed. Compiling something takes its time."""
_BEAT = 1.0  # [s] between two looks at the clock
_SIZE = 512
_NOBODY: Final = ord("-")
_BYTES: Final = {HOME: ord("0"), AWAY: ord("1")}


class Overtime(Exception):
    """A call of an agent took longer than anybody waits."""


class Watch(NotCopyable):
    """Watches the calls of a game's agents; a context that lasts as long as the game.

    Args:
        file: Where the game's status is shown; None for nowhere.
        patience: Longest time of a call, in [s].
    """

    def __init__(self, file: Path | None = None, patience: float = PATIENCE) -> None:
        self._file, self._patience = file, patience
        self._map: Any = bytearray(_SIZE)
        self._calls, self._seen, self._since = 0, -1, 0.0
        self._thread = threading.get_ident()
        self._over = threading.Event()
        self._handler: Any = None

    def __enter__(self) -> Self:
        if self._file is not None and self._file.parent.is_dir():  # a worker elsewhere may not see the folder
            with contextlib.suppress(OSError):  # where the disk is full, nothing is shown
                self._file.write_bytes(b"-".ljust(_SIZE))
                with self._file.open("r+b") as file:
                    self._map = mmap.mmap(file.fileno(), _SIZE)
        if threading.current_thread() is threading.main_thread():
            self._handler = signal.signal(signal.SIGALRM, self._on_alarm)
            signal.setitimer(signal.ITIMER_REAL, _BEAT, _BEAT)
        else:
            threading.Thread(target=self._look_from_outside, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        if self._handler is not None:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, self._handler)
        if isinstance(self._map, mmap.mmap):
            self._map.close()
            assert self._file is not None
            self._file.unlink(missing_ok=True)

    def enter(self, side: Side) -> None:
        """A call of this side's code begins."""
        self._map[0] = _BYTES[side]
        self._calls += 1

    def leave(self) -> None:
        """The call has returned."""
        self._map[0] = _NOBODY

    @contextlib.contextmanager
    def over(self, side: Side) -> Iterator[None]:
        """A context around a call of this side's code."""
        self.enter(side)
        try:
            yield
        finally:
            self.leave()

    def tell(self, status: Status) -> None:
        """Show how the game stands."""
        self._map[1:_SIZE] = msgspec.json.encode(status).ljust(_SIZE - 1)[: _SIZE - 1]

    def _is_overdue(self) -> bool:
        """Whether the present call has lasted too long; one that swallows its end is ended again and again."""
        now = time.monotonic()
        if self._map[0] == _NOBODY or self._calls != self._seen:
            self._seen, self._since = (
                self._calls,
                now,
            )  # first seen at this beat of the clock, to spare every call a look
            return False
        return now - self._since > self._patience

    def _on_alarm(self, *_: object) -> None:
        if self._is_overdue():
            raise Overtime(f"it did not return within {self._patience:g} s")

    def _look_from_outside(self) -> None:
        """Where signals do not reach, in a Dask worker's thread."""
        while not self._over.wait(_BEAT):
            if self._is_overdue():
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(self._thread), ctypes.py_object(Overtime))


def culprit(file: Path) -> Side | None:
    """Whose code was running when the process of a game died; None if nobody's, or if nobody can say."""
    try:
        with file.open("rb") as mapped:
            return {b"0": HOME, b"1": AWAY}.get(mapped.read(1))
    except OSError:
        return None


def live_games(folder: Path) -> list[Status]:
    """How the games stand that are being played into a folder, in the order of their names."""
    found = []
    for file in sorted(folder.glob("*")):
        try:
            found.append(msgspec.json.decode(file.read_bytes()[1:], type=Status))
        except (OSError, msgspec.MsgspecError, UnicodeDecodeError):
            continue  # it has just ended, is just being written, or has not begun to tell
    return found
