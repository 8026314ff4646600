"""Compile every player once, before several processes of tests would each do it.

    python scripts/compile_players.py

What is compiled stays in the cache beside the sources (`airhockey.envs.compiling`); a second run takes seconds.
"""

import time

from airhockey import envs
from airhockey.agents.registry import AGENTS

STEPS = 3


def main() -> None:
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


if __name__ == "__main__":
    main()
