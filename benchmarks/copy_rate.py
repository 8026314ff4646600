"""Planning copies per second against bare `mj_copyData` of the same model, in one run, interleaved.

    python benchmarks/copy_rate.py [--blocks 60] [--copies 200]

A planning copy is what a search does at each node: save the present moment (`env.get_state()`) and later go back to it
(`env.set_state(state)`). Between the two the environment makes a step, which is not timed, so that nothing is as it was saved.
The pair holds more than MuJoCo's data: controllers, filters, opponent, score, timers, random streams, what was seen of late.
Bare is one `mj_copyData` of the same model into data that is there already. Also given, in copies per second: `env.copy()`, a
whole environment of its own, and making a new one. The rates are those of the median copy, so that another process, which stops
a few of them for milliseconds, disturbs none.
"""

import argparse
import statistics
import time
from collections.abc import Callable

import mujoco
import numpy as np

from airhockey import envs

PROFILES = ("ideal", "server")


def standing(env: envs.Environment) -> object:
    """The action that keeps the robots where they start."""
    start = np.array(env.simulation.robot.start)
    action = np.stack((start, np.zeros_like(start)))
    return (action, action) if env.n_players == 2 else action


def timed(function: Callable[[], object]) -> float:
    """Seconds that a call takes."""
    begin = time.perf_counter()
    function()
    return time.perf_counter() - begin


def measure(name: str, profile: str, blocks: int, copies: int) -> tuple[float, float, float, float]:
    """Per second: planning copies, bare copies, whole copies, new environments."""
    env = envs.make(name, disturbances=profile)
    action, model, data = standing(env), env.simulation.model, env.simulation.data
    bare = mujoco.MjData(model)
    planning, plain, whole, new = [], [], [], []
    for block in range(blocks):
        env.reset(seed=block)
        for _ in range(copies):
            begin = time.perf_counter()
            state = env.get_state()
            saved = time.perf_counter() - begin
            env.step(action)
            begin = time.perf_counter()
            env.set_state(state)
            planning.append(saved + time.perf_counter() - begin)
            env.step(action)
            begin = time.perf_counter()
            mujoco.mj_copyData(bare, model, data)
            plain.append(time.perf_counter() - begin)
        whole.append(timed(env.copy))
        if block % 10 == 0:
            new.append(timed(lambda: envs.make(name, disturbances=profile)))
    planned, bared, copied, made = (1.0 / statistics.median(times) for times in (planning, plain, whole, new))
    return planned, bared, copied, made


def main() -> None:
    """Print a table: copies per second, and the ratio."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--blocks", type=int, default=60, help="how often to begin again")
    parser.add_argument("--copies", type=int, default=200, help="planning copies each time")
    options = parser.parse_args()
    print(
        f"{'environment':22s} {'save + go back/s':>16s} {'bare copy/s':>12s} {'ratio':>6s} {'env.copy/s':>11s} {'make/s':>7s}"
    )
    for profile in PROFILES:
        for name in envs.ENVIRONMENTS:
            planned, bared, copied, made = measure(name, profile, options.blocks, options.copies)
            label = f"{name}, {profile}"
            print(f"{label:22s} {planned:16.0f} {bared:12.0f} {planned / bared:6.2f} {copied:11.0f} {made:7.0f}")


if __name__ == "__main__":
    main()
