"""What a trained skill reaches on episodes that it was not trained on."""

import numpy as np

from airhockey.agents.atacom.network import Network
from airhockey.envs.disturbances import Disturbances
from airhockey.learning.sac.records import Settings
from airhockey.learning.sac.trainer import make_env

UNSEEN = 1
"""Second entry of the evaluation's seeds; those of training have one entry only."""


def evaluate_skill(settings: Settings, profile: Disturbances, network: Network, episodes: int) -> dict[str, float]:
    """Play the policy's mean.

    Args:
        settings, profile: Of the run.
        network: The policy.
        episodes: How many.

    Returns:
        Share of successes, mean return, and share of control steps that violated a constraint.
    """
    env, returns, successes = make_env(settings, profile), [], 0
    for k in range(episodes):
        seed = np.random.SeedSequence(settings.seed, spawn_key=(k, UNSEEN))
        observation, info = env.reset(options={"seed": seed})
        total, over = 0.0, False
        while not over:
            observation, reward, terminated, truncated, info = env.step(network(observation))
            total, over = total + reward, terminated or truncated
        returns.append(total)
        successes += bool(info["success"])
    return {
        "episodes": episodes,
        "success": successes / episodes,
        "mean_return": round(float(np.mean(returns)), 4),
        "violations": env.violations / env.steps,
    }
