"""Engines: they map jobs to results in this process, in many processes, or on a cluster.

    for job, result in engine.run(function, jobs):
        ...

`function` and the jobs are picklable. The function may keep what it built between jobs; its `close()`, if it has one, is
called when there are no more. Results come as they are ready. A pool keeps the function, and the workers, for several
runs. A job whose worker dies, again and again, gives a `JobFailed`.
"""

from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass
from typing import Protocol, TypeVar

from airhockey.evaluator.engines.pool import JobFailed, Pool
from airhockey.evaluator.engines.processes import Processes
from airhockey.evaluator.engines.workers import close

Job = TypeVar("Job")
Result = TypeVar("Result")


class Engine(Protocol):
    """Anything that maps jobs to results."""

    def run(
        self, function: Callable[[Job], Result], jobs: Iterable[Job]
    ) -> Generator[tuple[Job, Result | JobFailed], None, None]:
        """Yield each job with its result, in any order; raises what the function raises."""
        ...


class InProcess:
    """One job after the other, right here."""

    def run(
        self, function: Callable[[Job], Result], jobs: Iterable[Job]
    ) -> Generator[tuple[Job, Result | JobFailed], None, None]:
        """Yield each job with its result, in order; raises what the function raises."""
        with self.pool(function) as pool:
            yield from pool.run(jobs)

    def pool(self, function: Callable[[Job], Result]) -> Pool[Job, Result]:
        """A pool of this process alone."""
        return _InProcessPool(function)


@dataclass
class _InProcessPool(Pool[Job, Result]):
    function: Callable[[Job], Result]

    def run(self, jobs: Iterable[Job]) -> Generator[tuple[Job, Result | JobFailed], None, None]:
        for job in jobs:
            yield job, self.function(job)

    def __exit__(self, *_: object) -> None:
        close(self.function)


def engine_for(jobs: int) -> InProcess | Processes:
    """The engine for a number of parallel jobs."""
    return InProcess() if jobs == 1 else Processes(jobs)
