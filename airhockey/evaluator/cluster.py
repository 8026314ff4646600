"""The same jobs on a Dask cluster: many machines, or a few workers here.

A worker that dies costs the time of the job it was at; the scheduler gives that job to another one. Submissions named by a
path, and disturbance files, must lie at the same path on every worker's machine.
"""

import contextlib
import hashlib
import pickle
from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass
from typing import Any, TypeVar

from airhockey.errors import ConfigurationError, MissingDependencyError
from airhockey.evaluator.engines import Engine, Lost, engine_for

Job = TypeVar("Job")
Result = TypeVar("Result")

_LOCAL = "local:"
_AHEAD = 4  # jobs per worker that the scheduler holds at once
_functions: dict[str, Callable[[Any], Any]] = {}  # in a worker: what it built for a run stays until the next run


@dataclass(frozen=True)
class Cluster:
    """An engine on a Dask cluster.

    Attributes:
        address: Of a scheduler ("tcp://host:8786"), or "local:N" for N worker processes on this machine.
        attempts: How often a job is given to a worker before it is lost.
    """

    address: str
    attempts: int = 3

    def run(
        self, function: Callable[[Job], Result], jobs: Iterable[Job]
    ) -> Generator[tuple[Job, Result | Lost], None, None]:
        """Yield each job with its result, as they are ready; raises what the function raises."""
        distributed = _distributed()
        packed = pickle.dumps(function)
        name = hashlib.sha256(packed).hexdigest()
        with contextlib.ExitStack() as stack:
            client = stack.enter_context(self._client(distributed, stack))
            shared = client.scatter(packed, broadcast=True, hash=False)
            waiting = iter(jobs)
            running: dict[Any, tuple[Job, int]] = {}
            ready = distributed.as_completed()

            def submit(job: Job, attempt: int) -> None:
                future = client.submit(_work, name, shared, job, pure=False)
                running[future] = job, attempt
                ready.add(future)

            room = _AHEAD * max(1, len(client.scheduler_info()["workers"]))
            for job in _take(waiting, room):
                submit(job, 1)
            for future in ready:
                job, attempt = running.pop(future)
                error = future.exception()
                if error is None:
                    result: Result | Lost = future.result()
                elif not isinstance(error, distributed.scheduler.KilledWorker):
                    raise error
                elif attempt < self.attempts:
                    submit(job, attempt + 1)
                    continue
                else:
                    result = Lost(f"the worker process died {attempt} times over it")
                future.release()
                for following in _take(waiting, 1):
                    submit(following, 1)
                yield job, result

    def _client(self, distributed: Any, stack: contextlib.ExitStack) -> Any:
        if not self.address.startswith(_LOCAL):
            try:
                return distributed.Client(self.address, timeout="10s")
            except (OSError, ValueError) as error:
                raise ConfigurationError(f"no Dask scheduler answers at {self.address!r}: {error}") from error
        count = self.address.removeprefix(_LOCAL)
        if not count.isdigit() or int(count) < 1:
            raise ConfigurationError(f"--cluster {self.address!r}: after 'local:' comes a positive number of workers")
        cluster = distributed.LocalCluster(
            n_workers=int(count), threads_per_worker=1, processes=True, dashboard_address=None
        )
        return distributed.Client(stack.enter_context(cluster))


def engine_of(cluster: str | None, jobs: int) -> Engine:
    """The cluster at an address, or so many processes on this machine."""
    if cluster is None:
        return engine_for(jobs)
    _distributed()
    return Cluster(cluster)


def _work(name: str, packed: bytes, job: Any) -> Any:
    """In a worker: run the function, unpacked once per run."""
    if name not in _functions:
        for stale in list(_functions):
            closing = getattr(_functions.pop(stale), "close", None)
            if closing is not None:
                closing()
        _functions[name] = pickle.loads(packed)
    return _functions[name](job)


def _take(jobs: Any, most: int) -> list[Any]:
    return [job for _, job in zip(range(most), jobs, strict=False)]


def _distributed() -> Any:
    try:
        import distributed
    except ImportError as error:
        raise MissingDependencyError(
            "--cluster needs Dask, which is not installed; install it with: pip install 'airhockey[cluster]'"
        ) from error
    return distributed
