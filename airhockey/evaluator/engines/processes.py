"""The same jobs in worker processes on this machine."""

from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass, field
from multiprocessing import connection
from typing import Any, TypeVar

from airhockey.errors import EnvironmentFault
from airhockey.evaluator.engines.pool import JobFailed, Pool
from airhockey.evaluator.engines.workers import Task, Worker

Job = TypeVar("Job")
Result = TypeVar("Result")


@dataclass(frozen=True)
class Processes:
    """Worker processes, started afresh (spawn), each fed one job at a time through a pipe of its own.

    A pipe per worker tells which job a dead worker held: only that one is tried again, by a new worker.

    Attributes:
        count: Number of workers, ≥ 1.
        attempts: How often a job is given to a worker before it has failed, and how many workers in a row may die while they
            start.
    """

    count: int
    attempts: int = 3

    def run(
        self, function: Callable[[Job], Result], jobs: Iterable[Job]
    ) -> Generator[tuple[Job, Result | JobFailed], None, None]:
        """Yield each job with its result, as they are ready; raises what the function raises."""
        with self.pool(function) as pool:
            yield from pool.run(jobs)

    def pool(self, function: Callable[[Job], Result]) -> Pool[Job, Result]:
        """A pool of workers, which start with the first jobs."""
        return _WorkerPool(self, function)


@dataclass
class _WorkerPool(Pool[Any, Any]):
    """Workers, and the tasks that wait for them."""

    engine: Processes
    function: Callable[[Any], Any]
    busy: dict[Any, Worker] = field(default_factory=dict)
    idle: list[Worker] = field(default_factory=list)
    failed_starts: int = 0

    def run(self, jobs: Iterable[Any]) -> Generator[tuple[Any, Any], None, None]:
        self._fresh: Iterator[Any] = iter(jobs)
        self._retries: list[Task] = []
        while self.dispatch():
            for pipe in connection.wait(list(self.busy)):
                yield from self.receive(pipe)

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

    def dispatch(self) -> bool:
        """Start tasks while there are any and workers are allowed; say whether anything is under way."""
        while len(self.busy) < self.engine.count and (task := self.next_task()) is not None:
            worker = self.idle.pop() if self.idle else Worker.start(self.function)
            worker.send(task)
            self.busy[worker.pipe] = worker
        return bool(self.busy)

    def receive(self, pipe: Any) -> Generator[tuple[Any, Any], None, None]:
        """Receive a worker's result, or its failure."""
        worker = self.busy[pipe]
        try:
            answer = worker.receive()
        except (EOFError, OSError):
            yield from self.handle_exit(self.busy.pop(pipe))
            return
        if answer is None:
            self.failed_starts = 0
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

    def handle_exit(self, worker: Worker) -> Generator[tuple[Any, JobFailed], None, None]:
        """A worker died: its task is tried again, or has failed."""
        reason = worker.reap()
        if not worker.started:
            self.failed_starts += 1
            if self.failed_starts >= self.engine.attempts:
                raise EnvironmentFault(f"worker processes do not start ({reason}); one process does without: --jobs 1")
            worker.task.attempt -= 1  # it was never begun
            self._retries.append(worker.task)
            return
        if worker.task.attempt < self.engine.attempts:
            self._retries.append(worker.task)
        else:
            yield worker.task.job, JobFailed(f"the worker process died {worker.task.attempt} times over it ({reason})")
