"""Speed of a batch of environments against bare `mj_step` on as many threads, in one run, interleaved.

    python benchmarks/vector_rate.py [--blocks 20] [--steps 200] [--names 7dof-hit …] [--sizes 1 8 64] [--processes]

Every block times about `steps` control steps of the batch with 1 and with 2 threads, and the same number of
`mj_step(model, data, 20)` on copies of the same states with the same motor torques, in 1 and in 2 threads. A figure is that of
the median block, and a ratio the median of the blocks' ratios, so that another process on the machine disturbs all alike.
Names that end in a kind of actions are a learner's: ATACOM, the puck's filter, features and reward are part of every step.
`x2` is what the second thread brings; `CPU` is the ratio of the processor time of a step, which says what the batch adds to
`mj_step` whoever else is running. `--processes` adds Gymnasium's `AsyncVectorEnv` with two processes.
"""

import argparse
import functools
import statistics
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import mujoco
import numpy as np

from airhockey import envs
from airhockey.agents.learned.actions import ACTIONS
from airhockey.learning.envs.batch import LearningBatch

NAMES = ("7dof-hit", "7dof-defend", "tournament", "7dof-hit-tip", "7dof-defend-tip")
SIZES = (1, 8, 64)
THREADS = (1, 2)


def make(name: str, size: int, threads: int, disturbances: str) -> envs.VectorEnvironment:
    """A batch; of a learner's environment, with ATACOM, features and reward in every control step, where the name says so."""
    task, _, kind = name.rpartition("-")
    if kind in ACTIONS:
        return LearningBatch(task, size, kind, repeat=1, disturbances=disturbances, threads=threads, seed=0)
    return envs.make_vec(name, size, threads, 0, disturbances=disturbances)


def actions(vec: envs.VectorEnvironment, step: int) -> Any:
    """Smooth joint motion around the start for all, in the format of interpolation order 3; or a smooth action."""
    if isinstance(vec, LearningBatch):
        action = 0.5 * np.sin(0.1 * step + np.arange(vec.action_shape[0]))
        return np.broadcast_to(action, (vec.num_envs, *vec.action_shape))
    start = np.array(vec.single.simulation.robot.start)
    t, phases = 0.02 * (step + 1), np.arange(start.size)
    swing = 0.05 * (np.sin(2.0 * t + phases) - np.sin(phases))
    return np.broadcast_to(np.stack((start + swing, 0.1 * np.cos(2.0 * t + phases))), (vec.num_envs, *vec.action_shape))


class Bare:
    """`mj_step` alone, on copies of a batch's states."""

    def __init__(self, vec: envs.VectorEnvironment) -> None:
        self.model = vec.single.simulation.model
        self.data = [mujoco.MjData(self.model) for _ in range(vec.num_envs)]
        self.pool = ThreadPoolExecutor(max(THREADS))

    def copy(self, vec: envs.VectorEnvironment) -> None:
        """Take the present states over."""
        for data, (moment, _) in zip(self.data, envs.VectorEnvironment.get_state(vec), strict=True):
            vec.single.set_state(moment)
            mujoco.mj_copyData(data, self.model, vec.single.simulation.data)

    def run(self, threads: int, rounds: int) -> None:
        """Every state by `rounds` control steps."""
        list(self.pool.map(lambda k: self._some(self.data[k::threads], rounds), range(threads)))

    def _some(self, mine: list[Any], rounds: int) -> None:
        for _ in range(rounds):
            for data in mine:
                mujoco.mj_step(self.model, data, 20)


def timed(job: Callable[[], None], count: int) -> tuple[float, float]:
    """Wall and processor seconds of one of `count` control steps."""
    wall, cpu = time.perf_counter(), time.process_time()
    job()
    return (time.perf_counter() - wall) / count, (time.process_time() - cpu) / count


def play(vec: envs.VectorEnvironment, moves: list[Any], batch: Any) -> None:
    """As many rounds as there are moves."""
    for move in moves:
        vec.step(move, batch)


def measure(name: str, size: int, blocks: int, steps: int, disturbances: str) -> dict[tuple[str, int], list[Any]]:
    """Wall and processor time of a control step in every block, by ("batch" or "bare", threads)."""
    vecs = {threads: make(name, size, threads, disturbances) for threads in THREADS}
    bare, rounds = Bare(vecs[1]), max(1, steps // size)
    moves = [actions(vecs[1], k) for k in range(rounds)]
    batch = vecs[1].new_batch()
    times: dict[tuple[str, int], list[Any]] = {(kind, n): [] for kind in ("batch", "bare") for n in THREADS}
    for block in range(blocks + 1):
        for threads, vec in vecs.items():
            vec.reset(seed=block, into=batch)
            vec.step(moves[0], batch)
            bare.copy(vec)
            jobs = {
                "batch": functools.partial(play, vec, moves, batch),
                "bare": functools.partial(bare.run, threads, rounds),
            }
            for kind, job in jobs.items():
                spent = timed(job, rounds * size)
                if block:  # the first one compiles
                    times[kind, threads].append(spent)
    return times


def median_ratio(above: list[Any], below: list[Any], which: int) -> float:
    """Median over the blocks of the ratio of two times (0: wall, 1: processor)."""
    return float(statistics.median(a[which] / b[which] for a, b in zip(above, below, strict=True)))


def processes_rate(name: str, size: int, steps: int) -> float:
    """Control steps per second of Gymnasium's `AsyncVectorEnv`."""
    import gymnasium

    import airhockey.envs.gymnasium  # noqa: F401 - registers the ids

    makers = [lambda: gymnasium.make(f"airhockey.envs.gymnasium:airhockey/{name}-v0") for _ in range(size)]
    vec = gymnasium.vector.AsyncVectorEnv(makers)
    batch = envs.make_vec(name, size)
    vec.reset(seed=0)
    rounds = max(1, steps // size)
    moves = [actions(batch, k).copy() for k in range(rounds)]
    vec.step(moves[0])
    begin = time.perf_counter()
    for move in moves:
        vec.step(move)
    rate = rounds * size / (time.perf_counter() - begin)
    vec.close()
    return rate


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--blocks", type=int, default=20, help="blocks to take the median of")
    parser.add_argument("--steps", type=int, default=200, help="control steps in a block")
    parser.add_argument("--names", nargs="+", default=NAMES, help="environments")
    parser.add_argument("--sizes", nargs="+", type=int, default=SIZES, help="numbers of environments")
    parser.add_argument("--disturbances", default="ideal", help="profile")
    parser.add_argument("--processes", action="store_true", help="also AsyncVectorEnv, 2 environments in 2 processes")
    options = parser.parse_args()
    print(
        f"{'environment':12s} {'N':>4s} "
        + f"{'steps/s':>9s} {'/bare':>6s} {'CPU':>6s} " * 2
        + f"{'x2':>6s} {'bare x2':>8s}"
    )
    for name in options.names:
        for size in options.sizes:
            t = measure(name, size, options.blocks, options.steps, options.disturbances)
            row = f"{name:12s} {size:4d} "
            for threads in THREADS:
                batch, bare = t["batch", threads], t["bare", threads]
                rate = 1.0 / statistics.median(wall for wall, _ in batch)
                row += f"{rate:9.0f} {median_ratio(bare, batch, 0):6.3f} {median_ratio(bare, batch, 1):6.3f} "
            print(
                row
                + f"{median_ratio(t['batch', 1], t['batch', 2], 0):6.3f} {median_ratio(t['bare', 1], t['bare', 2], 0):8.3f}"
            )
        if options.processes and name in ("7dof-hit", "7dof-defend"):
            print(
                f"{name:12s} {2:4d} {processes_rate(name, 2, options.steps * 10):9.0f}  AsyncVectorEnv, two processes"
            )


if __name__ == "__main__":
    main()
