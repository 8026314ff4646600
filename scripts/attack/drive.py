"""Plays a few steps with an entry in a sandbox, as the evaluator does, under limits that an attacker reaches soon.

python -P drive.py ENTRY '{"memory": …}'
"""

import json
import sys

from airhockey import envs
from airhockey.errors import AirHockeyError
from airhockey.evaluator.isolation.build import build_agent
from airhockey.evaluator.isolation.limits import Limits


def main() -> None:
    """Play, and say in one line how it went."""
    env = envs.make("3dof-hit")
    agent = None
    try:
        agent = build_agent(sys.argv[1], env, mode="sandbox", limits=Limits(**json.loads(sys.argv[2])))
        agent.episode_start()
        observation = env.reset(seed=0)
        for _ in range(5):
            observation, *_ = env.step(agent.act(observation))
        print("played", flush=True)
    except AirHockeyError as error:
        print(f"{type(error).__name__}: {error}", flush=True)
    finally:
        if agent is not None:
            agent.close()


if __name__ == "__main__":
    main()
