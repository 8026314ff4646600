"""Speed of the whole environment step against bare `mj_step`, in one run, interleaved.

    python benchmarks/step_rate.py [--blocks 60] [--steps 50]

Every block times `steps` control steps of the environment (interpolation, controller, 20 substeps, observation, constraints,
verdict, info dictionary) and the same number of `mj_step(model, data, 20)` on a copy of the same state with the same motor
torques. The rate is that of the median block, so that another process on the machine disturbs both alike.
"""

import argparse
import statistics
import time

import mujoco
import numpy as np

from airhockey import envs

NAMES = ("3dof-hit", "7dof-hit", "7dof-prepare", "tournament")


def actions(env: envs.Environment, steps: int) -> list[object]:
    """Smooth joint motion around the start, in the format of interpolation order 3."""
    n = env.env_info["robot"]["n_joints"]
    start = np.array(env.simulation.robot.start)
    phases = np.arange(n)
    result: list[object] = []
    for k in range(steps):
        t = 0.02 * (k + 1)
        swing = 0.05 * (np.sin(2.0 * t + phases) - np.sin(phases))
        action = np.stack((start + swing, 0.1 * np.cos(2.0 * t + phases)))
        result.append((action, action) if env.n_players == 2 else action)
    return result


def measure(name: str, blocks: int, steps: int) -> tuple[float, float]:
    """Median control steps per second of the environment, and of bare `mj_step`."""
    env = envs.make(name)
    moves = actions(env, steps)
    model, bare = env.simulation.model, mujoco.MjData(env.simulation.model)
    whole_times, bare_times = [], []
    for block in range(blocks + 1):
        env.reset(seed=block)
        env.step(moves[0])
        mujoco.mj_copyData(bare, model, env.simulation.data)
        begin = time.perf_counter()
        for move in moves[1:]:
            env.step(move)
        middle = time.perf_counter()
        for _ in moves[1:]:
            mujoco.mj_step(model, bare, 20)
        end = time.perf_counter()
        if block:  # the first one compiles
            whole_times.append((middle - begin) / (steps - 1))
            bare_times.append((end - middle) / (steps - 1))
    return 1.0 / statistics.median(whole_times), 1.0 / statistics.median(bare_times)


def main() -> None:
    """Print a table: control steps per second of both, and the ratio."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--blocks", type=int, default=60, help="blocks to take the median of")
    parser.add_argument("--steps", type=int, default=50, help="control steps in a block")
    options = parser.parse_args()
    print(f"{'environment':14s} {'steps/s':>9s} {'bare mj_step':>13s} {'ratio':>7s} {'x real time':>12s}")
    for name in NAMES:
        whole, bare = measure(name, options.blocks, options.steps)
        print(f"{name:14s} {whole:9.0f} {bare:13.0f} {whole / bare:7.3f} {whole * 0.02:12.1f}")


if __name__ == "__main__":
    main()
