"""What the evaluator costs on top of simulation and agent, how two jobs compare with one, and a worker's memory.

    python benchmarks/evaluator_cost.py [--env 7dof-prepare] [--agent thesis] [--episodes 200]

The share is measured in one process: the whole run's time, storing and reporting included, less the time inside the
environment and the agent. The speed-up is measured twice: over the whole run, where workers start, import and load compiled
code, and between episodes once every worker plays.
"""

import argparse
import multiprocessing
import os
import tempfile
import time
from collections.abc import Callable, Generator, Iterable
from pathlib import Path
from typing import Any

from airhockey.evaluator.engines.workers import ONE_THREAD

os.environ.update(ONE_THREAD)

from airhockey.evaluator import Engine, InProcess, Options, Processes, begin, evaluate
from airhockey.evaluator.runs.records import Job

WARM_UP = 10**6  # an index that no run gets to


class Watched(InProcess):
    """Plays here and adds up the time spent in the environment's and the agent's calls."""

    def __init__(self, env: str) -> None:
        self.env = env
        self.simulation = self.agent = self.began = 0.0

    def run(self, function: Any, jobs: Iterable[Any]) -> Generator[tuple[Any, Any], None, None]:
        """Play one episode to warm up, then start to count."""
        function(Job(self.env, WARM_UP))
        rollout = function.open(Job(self.env, WARM_UP))
        (seat,) = rollout.seats
        for owner, name, kind in (
            (rollout.env, "reset", "simulation"),
            (rollout.env, "step", "simulation"),
            (seat.agent, "episode_start", "agent"),
            (seat.agent, "act", "agent"),
        ):
            setattr(owner, name, self._timed(getattr(owner, name), kind))
        self.began = time.perf_counter()
        yield from super().run(function, jobs)

    def _timed(self, call: Callable[..., Any], kind: str) -> Callable[..., Any]:
        def timed(*arguments: Any, **named: Any) -> Any:
            began = time.perf_counter()
            result = call(*arguments, **named)
            setattr(self, kind, getattr(self, kind) + time.perf_counter() - began)
            return result

        return timed


def own_share(options: Options, folder: Path) -> tuple[float, float, float]:
    """Shares of a run's time spent in the simulation, in the agent, and in the evaluator itself."""
    watched = Watched(options.environments[0])
    evaluate(begin(options, folder), watched)
    whole = time.perf_counter() - watched.began
    simulation, agent = watched.simulation / whole, watched.agent / whole
    return simulation, agent, 1.0 - simulation - agent


def rates(options: Options, folder: Path, engine: Engine, skip: int) -> tuple[float, float, float]:
    """Episodes per second over the whole run and without the first `skip`, and a worker's peak memory in [MB]."""
    ends: list[float] = []
    peak = 0.0

    def on_episode(_: object) -> None:
        nonlocal peak
        ends.append(time.perf_counter())
        peak = max([peak, *(peak_memory(child.pid) for child in multiprocessing.active_children())])

    began = time.perf_counter()
    evaluate(begin(options, folder), engine, on_episode)
    whole = options.episodes / (time.perf_counter() - began)
    return whole, (options.episodes - skip) / (ends[-1] - ends[skip - 1]), peak


def peak_memory(process: int | None) -> float:
    """Largest resident memory of a process so far, in [MB]; 0 for one that has ended."""
    try:
        status = Path(f"/proc/{process}/status").read_text()
    except OSError:
        return 0.0
    return next((float(line.split()[1]) / 1e3 for line in status.splitlines() if line.startswith("VmHWM")), 0.0)


def main() -> None:
    """Print the three figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--env", default="7dof-prepare")
    parser.add_argument("--agent", default="thesis")
    parser.add_argument("--episodes", type=int, default=200)
    parser.add_argument("--disturbances", default="server")
    given = vars(parser.parse_args())
    options = Options(environments=(given.pop("env"),), **given)
    print(f"{options.environments[0]}, {options.agent}, {options.episodes} episodes, {options.disturbances}")
    with tempfile.TemporaryDirectory() as folder:
        shares = own_share(options, Path(folder) / "watched")
        print("simulation {:.1%}, agent {:.1%}, evaluator {:.1%}".format(*shares))
        one = rates(options, Path(folder) / "one", InProcess(), skip=4)
        two = rates(options, Path(folder) / "two", Processes(2), skip=4)
    print(f"one job  {one[0]:6.2f} episodes/s, {one[1]:6.2f} once it plays")
    print(f"two jobs {two[0]:6.2f} episodes/s, {two[1]:6.2f} once they play")
    print(f"speed-up {two[0] / one[0]:6.2f},            {two[1] / one[1]:6.2f} once they play")
    print(f"a worker's peak memory {two[2]:.0f} MB")


if __name__ == "__main__":
    main()
