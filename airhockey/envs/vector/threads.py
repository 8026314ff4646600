"""Threads that wait for work: handing a call to them costs a few microseconds, where an executor's future costs tens."""

import threading
import weakref
from collections.abc import Callable
from typing import Any

from airhockey.envs.copying import NotCopyable
from airhockey.errors import ConfigurationError

Call = tuple[Callable[..., Any], tuple[Any, ...]]


class Threads(NotCopyable):
    """The calling thread and `count − 1` more, which do the same call at the same time.

    Args:
        count: At least 1.
        most: How many have work at all; no more are started.
    """

    def __init__(self, count: int, most: int | None = None) -> None:
        if isinstance(count, bool) or not isinstance(count, int) or count < 1:
            raise ConfigurationError(f"{count!r} threads: it must be a whole number from 1 up, best that of the cores")
        self.count = count if most is None else min(count, most)
        self._helpers = [_Helper() for _ in range(self.count - 1)]
        self._stop = weakref.finalize(self, _stop, self._helpers)

    def run(self, function: Callable[..., Any], *arguments: Any) -> None:
        """Call a function in every thread, and wait for all; the first exception is raised."""
        for helper in self._helpers:
            helper.begin((function, arguments))
        try:
            function(*arguments)
        finally:
            failures = [helper.wait() for helper in self._helpers]
        for failure in failures:
            if failure is not None:
                raise failure

    def close(self) -> None:
        """End the threads."""
        self._stop()


class _Helper:
    """A thread that waits for a call, makes it, and waits again."""

    def __init__(self) -> None:
        self._go, self._done = threading.Lock(), threading.Lock()
        self._go.acquire()
        self._done.acquire()
        self._call: Call | None = None
        self._failure: BaseException | None = None
        threading.Thread(target=self._work, name="airhockey-vector", daemon=True).start()

    def begin(self, call: Call | None) -> None:
        """Let it make a call; None ends the thread."""
        self._call = call
        self._go.release()

    def wait(self) -> BaseException | None:
        """Wait for the call's end; gives what it raised."""
        self._done.acquire()
        self._call = None
        return self._failure

    def _work(self) -> None:
        while True:
            self._go.acquire()
            if self._call is None:
                return
            function, arguments = self._call
            try:
                function(*arguments)
                self._failure = None
            except BaseException as failure:  # handed to the thread that asked
                self._failure = failure
            del function, arguments
            self._done.release()


def _stop(helpers: list[_Helper]) -> None:
    for helper in helpers:
        helper.begin(None)
