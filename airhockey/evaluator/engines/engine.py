"""Engines: they map jobs to results in this process, in many processes, and later on a cluster.

    for job, result in engine.run(function, jobs):
        ...

`function` and the jobs are picklable. The function may keep what it built between jobs; its `close()`, if it has one, is
called when there are no more. Results come as they are ready. A shift keeps the function, and the workers, for several
runs. A job whose worker dies, again and again, gives a `JobFailed`.
"""

import abc
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from multiprocessing import connection
from typing import Any, Generic, Protocol, TypeVar

from airhockey.errors import AirHockeyError
from airhockey.evaluator.engines.workers import Task, Worker, close

Job = TypeVar("Job")
Result = TypeVar("Result")


@dataclass(frozen=True)
class JobFailed:
    """What a job gives whose worker died every time.

    Attributes:
        reason: One line.
    """

    reason: str


class Engine(Protocol):
    """Anything that maps jobs to results."""

    def run(
        self, function: Callable[[Job], Result], jobs: Iterable[Job]
    ) -> Generator[tuple[Job, Result | JobFailed], None, None]:
        """Yield each job with its result, in any order; raises what the function raises."""
        ...


class Shift(AbstractContextManager["Shift[Job, Result]"], Generic[Job, Result]):
    """Several runs of one function after another, which keeps what it built and where it runs until the shift ends."""

    @abc.abstractmethod
    def run(self, jobs: Iterable[Job]) -> Generator[tuple[Job, Result | JobFailed], None, None]:
        """Yield each job with its result, in any order; raises what the function raises."""


class InProcess:
    """One job after the other, right here."""

    def run(
        self, function: Callable[[Job], Result], jobs: Iterable[Job]
    ) -> Generator[tuple[Job, Result | JobFailed], None, None]:
        """Yield each job with its result, in order; raises what the function raises."""
        with self.shift(function) as shift:
            yield from shift.run(jobs)

    def shift(self, function: Callable[[Job], Result]) -> Shift[Job, Result]:
        """Begin a shift."""
        return _Here(function)


@dataclass
class _Here(Shift[Job, Result]):
    function: Callable[[Job], Result]

    def run(self, jobs: Iterable[Job]) -> Generator[tuple[Job, Result | JobFailed], None, None]:
        for job in jobs:
            yield job, self.function(job)

    def __exit__(self, *_: object) -> None:
        close(self.function)


@dataclass(frozen=True)
class Processes:
    """Worker processes, started afresh (spawn), each fed one job at a time through a pipe of its own.

    A pipe per worker tells which job a dead worker held: only that one is tried again, by a new worker.

    Attributes:
        count: Number of workers, ≥ 1.
        attempts: How often a job is given to a worker before it is lost.
    """

    count: int
    attempts: int = 3

    def run(
        self, function: Callable[[Job], Result], jobs: Iterable[Job]
    ) -> Generator[tuple[Job, Result | JobFailed], None, None]:
        """Yield each job with its result, as they are ready; raises what the function raises."""
        with self.shift(function) as shift:
            yield from shift.run(jobs)

    def shift(self, function: Callable[[Job], Result]) -> Shift[Job, Result]:
        """Begin a shift."""
        return _Crew(self, function)


@dataclass
class _Crew(Shift[Any, Any]):
    """The workers of one shift, and the tasks that wait for them."""

    engine: Processes
    function: Callable[[Any], Any]
    busy: dict[Any, Worker] = field(default_factory=dict)
    idle: list[Worker] = field(default_factory=list)

    def run(self, jobs: Iterable[Any]) -> Generator[tuple[Any, Any], None, None]:
        self._fresh: Iterator[Any] = iter(jobs)
        self._retries: list[Task] = []
        while self.staff():
            for pipe in connection.wait(list(self.busy)):
                yield from self.listen(pipe)

    def __exit__(self, failure: type[BaseException] | None, *_: object) -> None:
        try:
            for worker in self.idle if failure is None else ():
                worker.finish()
        finally:
            for worker in (*self.busy.values(), *self.idle):
                worker.kill()

    def next_task(self) -> Task | None:
        """The next task, those to be tried again first."""
        return self._retries.pop() if self._retries else next((Task(job) for job in self._fresh), None)

    def staff(self) -> bool:
        """Start tasks while there are any and workers are allowed; say whether anything is under way."""
        while len(self.busy) < self.engine.count and (task := self.next_task()) is not None:
            worker = self.idle.pop() if self.idle else Worker.start(self.function)
            worker.send(task)
            self.busy[worker.pipe] = worker
        return bool(self.busy)

    def listen(self, pipe: Any) -> Generator[tuple[Any, Any], None, None]:
        """Take what a worker says: its result, if that is it."""
        worker = self.busy[pipe]
        try:
            answer = worker.receive()
        except (EOFError, OSError):
            yield from self.mourn(self.busy.pop(pipe))
            return
        if answer is None:
            return
        error, result = answer
        if error is not None:
            raise error
        job = worker.task.job
        task = self.next_task()
        if task is not None:
            worker.send(task)  # it goes on while the caller looks at the result
        else:
            self.idle.append(self.busy.pop(pipe))
        yield job, result

    def mourn(self, worker: Worker) -> Generator[tuple[Any, JobFailed], None, None]:
        """A worker died: its task is tried again, or lost."""
        reason = worker.bury()
        if not worker.started:
            raise AirHockeyError(f"worker processes do not start ({reason}); one process does without: --jobs 1")
        if worker.task.attempt < self.engine.attempts:
            self._retries.append(worker.task)
        else:
            yield worker.task.job, JobFailed(f"the worker process died {worker.task.attempt} times over it ({reason})")


def engine_for(jobs: int) -> InProcess | Processes:
    """The engine for a number of parallel jobs."""
    return InProcess() if jobs == 1 else Processes(jobs)
