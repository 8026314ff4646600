"""A worker process: one pipe, one function, one job at a time."""

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from multiprocessing import connection, get_context, parent_process
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

from airhockey.errors import ConfigurationError

# Two workers must not fight over the cores, and a sum must not depend on how many threads shared it.
ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMEXPR_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "VECLIB_MAXIMUM_THREADS": "1",
}
SAFE_PATH = {"PYTHONSAFEPATH": "1"}
"""No child of ours imports from the present folder, which may be anybody's."""
PATIENCE = 5.0  # [s] for a worker to end when asked to
HELLO = "hello"


@dataclass
class Task:
    """A job and how many workers were given it so far."""

    job: Any
    attempt: int = 0


@dataclass
class Worker:
    """A worker as its parent sees it.

    Attributes:
        pipe: Jobs go in; a hello, then (error, result) pairs come out; its end is the worker's.
        task: The one that it was given last.
        started: Whether it has said hello.
    """

    process: BaseProcess
    pipe: Any
    task: Task
    started: bool = False

    @classmethod
    def start(cls, function: Callable[[Any], Any]) -> "Worker":
        """Start a process that will call `function`."""
        check_script()
        context = get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=_work, args=(theirs, function), daemon=True)
        with children_environment(), no_interrupts():
            process.start()
        theirs.close()  # or a dead worker would not show as the end of our pipe
        return cls(process, ours, Task(None))

    def send(self, task: Task) -> None:
        """Give it a task."""
        task.attempt += 1
        self.task = task
        with contextlib.suppress(OSError):  # one that died meanwhile shows when its answer is read
            self.pipe.send(task.job)

    def receive(self) -> tuple[BaseException | None, Any] | None:
        """What the function raised and what it returned; None while it has only said hello.

        Raises:
            EOFError, OSError: It died.
        """
        answer = self.pipe.recv()
        if answer == HELLO:
            self.started = True
            return None
        error, result = answer
        return error, result

    def reap(self) -> str:
        """Clean up after a dead worker and say how it died."""
        self.finish()
        self.kill()
        code = self.process.exitcode or 0
        return f"signal {signal.Signals(-code).name}" if code < 0 else f"exit status {code}"

    def finish(self) -> None:
        """Let an idle worker end in peace."""
        self.pipe.close()
        self.process.join(PATIENCE)

    def kill(self) -> None:
        """End it now."""
        if self.process.is_alive():
            self.process.kill()
            self.process.join()


def check_script() -> None:
    """A script that starts workers is imported by each of them, and must not do its work again then.

    Raises:
        ConfigurationError: It would.
    """
    main = sys.modules.get("__main__")
    file = getattr(main, "__file__", None)
    if file is None or getattr(main, "__spec__", None) is not None:
        return
    try:
        guarded = "__main__" in Path(file).read_text(errors="replace")
    except OSError:
        return
    if not guarded:
        raise ConfigurationError(
            f"{file!r} starts worker processes, and each of them imports it: put what it does under "
            'if __name__ == "__main__":, or play in one process (InProcess(), jobs=1)'
        )


def close(function: Any) -> None:
    """Call a function's `close()`, if it has one."""
    closing = getattr(function, "close", None)
    if closing is not None:
        closing()


def _work(pipe: Any, function: Callable[[Any], Any]) -> None:
    """Main function of a worker: jobs in, results out, until the pipe or the parent is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's business
    threading.Thread(target=_die_with_parent, daemon=True).start()
    with contextlib.suppress(EOFError, OSError):
        pipe.send(HELLO)
        while True:
            job = pipe.recv()
            answer: tuple[BaseException | None, Any]
            try:
                answer = (None, function(job))
            except BaseException as error:
                error.add_note("raised in a worker process")
                answer = (error, None)
            pipe.send(answer)
    close(function)


def _die_with_parent() -> None:
    """A parent that was killed closes no pipe in the middle of a job."""
    parent = parent_process()
    if parent is not None:
        connection.wait([parent.sentinel])
        os._exit(1)


@contextlib.contextmanager
def children_environment() -> Iterator[None]:
    """Single-threaded libraries, and nothing imported from the present folder, for processes started inside the block."""
    surroundings = ONE_THREAD | SAFE_PATH
    before = {name: os.environ.get(name) for name in surroundings}
    os.environ.update(surroundings)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextlib.contextmanager
def no_interrupts() -> Iterator[None]:
    """No Ctrl-C from the first moment on, for processes started inside the block."""
    in_main_thread = threading.current_thread() is threading.main_thread()
    handler = signal.signal(signal.SIGINT, signal.SIG_IGN) if in_main_thread else None
    try:
        yield
    finally:
        if in_main_thread:
            signal.signal(signal.SIGINT, handler)
