"""Compile every player and the batches once, before several processes of tests would each do it.

    python scripts/compile_players.py

What is compiled stays in the cache beside the sources (`airhockey.envs.compiling`); a second run takes seconds. Players and
batches have little in common, and are compiled at the same time.
"""

import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np

from airhockey import envs
from airhockey.agents.registry import AGENTS
from airhockey.learning.envs.batch import LearningBatch

STEPS = 3
LEARNERS = ("3dof-defend",)
"""Where tests learn; what differs between the tasks of a robot, or between kinds of actions, is not compiled in."""


def compile_players() -> None:
    """Build each player for each robot that it plays, and let it act."""
    for robot in ("7dof", "3dof"):
        for name, entry in AGENTS.items():
            played = [env for env in entry.environments if env.startswith(robot)]
            began = time.perf_counter()
            for env_name in played:
                env = envs.make(env_name)
                agent = entry.build(env.env_info)
                agent.episode_start()
                observation = env.reset(seed=0)
                for _ in range(STEPS):
                    observation, *_ = env.step(agent.draw_action(observation))
            if played:
                print(f"{name:14} {robot}: {time.perf_counter() - began:.1f} s", flush=True)


def compile_batches() -> None:
    """Step one environment of each kind."""
    kinds = [(name, envs.make_vec) for name in envs.ENVIRONMENTS] + [(name, LearningBatch) for name in LEARNERS]
    for name, make in kinds:
        began = time.perf_counter()
        batch = make(name, 1)
        batch.step(np.zeros((1, *batch.action_shape)))
        print(f"{make.__name__:14} {name}: {time.perf_counter() - began:.1f} s", flush=True)


def main() -> None:
    """Compile all, in two processes."""
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        for job in [pool.submit(compile_players), pool.submit(compile_batches)]:
            job.result()


if __name__ == "__main__":
    main()
