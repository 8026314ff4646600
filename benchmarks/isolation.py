"""What a process of its own costs an agent: the median time of `draw_action`, over that of an agent in this process.

    python benchmarks/isolation.py [--steps 5000] [--agent hold] [--bound 100]

Exit status 1: a mode costs more than the bound, in microseconds. The modes take turns, so that a busy machine is busy for all.
"""

import argparse
import statistics
import sys
import time
from typing import Any

from airhockey import envs
from airhockey.evaluator.isolation.build import build_agent
from airhockey.evaluator.isolation.modes import Mode
from airhockey.evaluator.isolation.sandbox import why_no_sandbox

ROUND = 100


def main() -> int:
    """Measure, print a table, and judge."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=5000)
    parser.add_argument("--agent", default="hold")
    parser.add_argument("--bound", type=float, default=100.0, help="[µs]")
    given = parser.parse_args()
    without = why_no_sandbox()
    modes: tuple[Mode, ...] = ("none", "process") if without else ("none", "process", "sandbox")
    env = envs.make("7dof-hit")
    times = measure(env, given.agent, modes, given.steps)
    base = statistics.median(times["none"])
    print(f"{given.agent}, {given.steps} steps of 7dof-hit; draw_action in µs")
    print(f"{'mode':10}{'median':>10}{'p99':>10}{'overhead':>10}")
    worst = 0.0
    for mode, seconds in times.items():
        median, p99 = statistics.median(seconds), statistics.quantiles(seconds, n=100)[98]
        worst = max(worst, (median - base) * 1e6)
        print(f"{mode:10}{median * 1e6:10.1f}{p99 * 1e6:10.1f}{(median - base) * 1e6:10.1f}")
    if without:
        print(f"no sandbox: {without}")
    return int(worst > given.bound)


def measure(env: Any, agent: str, modes: tuple[Mode, ...], steps: int) -> dict[Mode, list[float]]:
    """Times of `draw_action` in each mode, in [s]."""
    players = {mode: build_agent(agent, env, mode=mode) for mode in modes}
    times: dict[Mode, list[float]] = {mode: [] for mode in modes}
    try:
        while len(times["none"]) < steps:
            for mode, player in players.items():
                player.episode_start()
                observation = env.reset(seed=len(times[mode]))
                for _ in range(ROUND):
                    began = time.perf_counter()
                    action = player.act(observation)
                    times[mode].append(time.perf_counter() - began)
                    observation, *_ = env.step(action)
    finally:
        for player in players.values():
            player.stop()
    return times


if __name__ == "__main__":
    sys.exit(main())
