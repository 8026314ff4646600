"""The same jobs on a Dask cluster: many machines, or a few workers here.

A worker that dies costs the time of the job it was at; that job goes to another one. Submissions named by a path, and
disturbance files, must lie at the same path on every worker's machine, and airhockey in the same versions. Start workers with
one thread each (`dask worker --nthreads 1 --nworkers N`): an agent may draw from generators that a whole process shares.
"""

import asyncio
import concurrent.futures
import contextlib
import hashlib
import logging
import pickle
import tempfile
import threading
import time
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Any, TypeVar

from airhockey import envs
from airhockey.errors import AirHockeyError, ConfigurationError, MissingDependencyError
from airhockey.evaluator.engines.engine import Engine, engine_for
from airhockey.evaluator.engines.pool import JobFailed
from airhockey.evaluator.engines.processes import Processes
from airhockey.evaluator.engines.workers import ONE_THREAD, SAFE_PATH, children_environment, close, no_interrupts

Job = TypeVar("Job")
Result = TypeVar("Result")

_LOCAL = "local:"
_AHEAD = 4  # jobs per worker that the scheduler holds at once
_COUNT = 5.0  # [s] between two looks at how many workers there are
_PATIENCE = "10s"  # for a scheduler to answer
_built: dict[str, Callable[[Any], Any]] = {}  # in a worker: what it built for a run stays until the next run
_one_at_a_time = threading.Lock()


@dataclass(frozen=True)
class Cluster:
    """An engine on a Dask cluster.

    Attributes:
        address: Of a scheduler ("tcp://host:8786"), or "local:N" for N worker processes on this machine.
        attempts: How many workers may die over a job before it is lost. (Other clusters than local ones have a say in it:
            their `distributed.scheduler.allowed-failures`.)
    """

    address: str
    attempts: int = 3

    def __post_init__(self) -> None:
        count = self.address.removeprefix(_LOCAL)
        if self.is_local and not (count.isdecimal() and int(count)):
            raise ConfigurationError(f"--cluster {self.address!r}: after 'local:' comes a positive number of workers")

    @property
    def is_local(self) -> bool:
        """Whether the workers are started here, for the run."""
        return self.address.startswith(_LOCAL)

    def run(
        self, function: Callable[[Job], Result], jobs: Iterable[Job]
    ) -> Generator[tuple[Job, Result | JobFailed], None, None]:
        """Yield each job with its result, as they are ready; raises what the function raises."""
        with _connected(self) as client:
            flow = _Flow(self, client, function, iter(jobs))
            with _scheduler_errors(self.address):
                yield from flow.results()
                flow.close()

    def check(self) -> None:
        """Find out whether a scheduler answers, with workers that play one job at a time; raises `ConfigurationError`."""
        if self.is_local:
            _distributed()
            return
        with _connected(self) as client:
            threads = set(client.nthreads().values())
        if threads - {1}:
            raise ConfigurationError(
                f"the workers at {self.address!r} have {max(threads)} threads each; start them with --nthreads 1 "
                "(and --nworkers for one per core): jobs of one process would disturb each other"
            )


class _Flow:
    """The jobs of one run on their way through a cluster."""

    def __init__(self, cluster: Cluster, client: Any, function: Callable[[Any], Any], jobs: Iterator[Any]) -> None:
        self._cluster, self._client, self._jobs = cluster, client, jobs
        self._packed = pickle.dumps(function)
        self._name = hashlib.sha256(self._packed).hexdigest()
        self._running: dict[Any, tuple[Any, int]] = {}
        self._ready = _distributed().as_completed()
        self._counted_at, self._workers = -_COUNT, 1

    def results(self) -> Generator[tuple[Any, Any], None, None]:
        """Keep the cluster busy, and give what it has done."""
        killed = _distributed().scheduler.KilledWorker
        self._fill()
        for future in self._ready:
            job, attempt = self._running.pop(future)
            error = future.exception()
            if error is None:
                result = future.result()
            elif not isinstance(error, killed):
                raise error
            elif not self._cluster.is_local and attempt < self._cluster.attempts:
                self._submit(job, attempt + 1)
                continue
            else:
                result = JobFailed(f"the worker process died {self._cluster.attempts} times over it")
            future.release()
            self._fill()
            yield job, result

    def close(self) -> None:
        """There are no more jobs: the workers forget what they built."""
        self._client.run(_forget)

    def _fill(self) -> None:
        """Submit jobs as long as there are fewer than a few per worker; workers may come and go."""
        if time.monotonic() - self._counted_at > _COUNT:
            self._counted_at, self._workers = time.monotonic(), max(1, len(self._client.nthreads()))
        room = max(0, _AHEAD * self._workers - len(self._running))
        for job in islice(self._jobs, room):
            self._submit(job, 1)

    def _submit(self, job: Any, attempt: int) -> None:
        future = self._client.submit(_work, self._name, self._packed, envs.versions(), job, pure=False)
        self._running[future] = job, attempt
        self._ready.add(future)


def engine_of(cluster: str | None, jobs: int, isolated: bool = False) -> Engine:
    """The cluster at an address, or so many processes on this machine.

    Args:
        cluster: Address, see `Cluster`; None for this machine.
        jobs: Number of processes.
        isolated: Never in this process, so that a job that kills its process is only lost.

    Raises:
        ConfigurationError: The address has no meaning, or nobody answers there.
        MissingDependencyError: Dask is not installed.
    """
    if cluster is None:
        return Processes(jobs) if isolated else engine_for(jobs)
    engine = Cluster(cluster)
    engine.check()
    return engine


def _work(name: str, packed: bytes, versions: dict[str, str], job: Any) -> Any:
    """In a worker: run the function, unpacked once per run."""
    with _one_at_a_time:
        if name not in _built:
            _forget()
            if envs.versions() != versions:
                raise ConfigurationError(f"a worker has {envs.versions()}, but the run is of {versions}")
            _built[name] = pickle.loads(packed)
        return _built[name](job)


def _forget() -> None:
    """In a worker: close what was built for the last run."""
    while _built:
        close(_built.popitem()[1])


@contextlib.contextmanager
def _connected(cluster: Cluster) -> Iterator[Any]:
    """A client of the cluster."""
    distributed = _distributed()
    with contextlib.ExitStack() as stack:
        if cluster.is_local:
            workers = stack.enter_context(_local(int(cluster.address.removeprefix(_LOCAL)), cluster.attempts))
            yield stack.enter_context(distributed.Client(workers))
            return
        try:
            client = distributed.Client(cluster.address, timeout=_PATIENCE)
        except (OSError, ValueError) as error:
            raise ConfigurationError(f"no Dask scheduler answers at {cluster.address!r}: {error}") from error
        yield stack.enter_context(client)


@contextlib.contextmanager
def _local(workers: int, attempts: int) -> Iterator[Any]:
    """Workers on this machine, that leave Ctrl-C to their parent; only the job that a dead one was at is blamed."""
    import dask

    settings = {"distributed.scheduler.worker-saturation": 1.0, "distributed.scheduler.allowed-failures": attempts - 1}
    scratch = tempfile.TemporaryDirectory(prefix="airhockey-cluster-", ignore_cleanup_errors=True)
    with scratch as folder, dask.config.set(settings | {"temporary-directory": folder}), children_environment():
        with no_interrupts():
            cluster = _distributed().LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                dashboard_address=None,
                env=ONE_THREAD | SAFE_PATH,
                silence_logs=logging.CRITICAL,
                security=_certificates(),
            )
        with cluster:
            yield cluster


def _certificates() -> Any:
    """Keys for this run alone: whoever may connect to a scheduler may run code as its owner, and loopback is open to all users.

    Raises:
        MissingDependencyError: The package that makes certificates is not installed.
    """
    try:
        return _distributed().security.Security.temporary()
    except ImportError as error:
        raise MissingDependencyError(
            f"--cluster {_LOCAL}N needs certificates: {error}; pip install 'airhockey[cluster]'"
        ) from error


@contextlib.contextmanager
def _scheduler_errors(address: str) -> Iterator[None]:
    """A scheduler that went away, as an error of ours."""
    try:
        yield
    except (
        _distributed().comm.CommClosedError,
        concurrent.futures.CancelledError,
        asyncio.CancelledError,
    ) as error:
        raise AirHockeyError(f"the Dask scheduler at {address!r} went away: {error}; go on with --resume") from error


def _distributed() -> Any:
    try:
        import distributed
    except ImportError as error:
        raise MissingDependencyError(
            "--cluster needs Dask, which is not installed; install it with: pip install 'airhockey[cluster]'"
        ) from error
    return distributed
