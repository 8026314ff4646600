"""The table, the arm and its start posture are symmetric: a mirrored situation is met with the mirrored action, to rounding.

It holds of whole skills in the loop with the simulation, until something is drawn at random or a contact magnifies rounding.
"""

import numpy as np
import pytest

from airhockey import envs
from airhockey.agents.registry import AGENTS

SIGNS = np.array([-1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
"""What the reflection at the table's long axis does to the joints of the iiwa."""
CLOSE = 1e-9


def mirrored(base: np.ndarray) -> np.ndarray:
    """A base observation of one arm, reflected: puck x, y, yaw and rates, joint positions, joint velocities."""
    puck = base[:6] * np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])
    return np.concatenate([puck, base[6:13] * SIGNS, base[13:20] * SIGNS])


def commands(name: str, env: envs.Environment, start: np.ndarray, steps: int) -> np.ndarray:
    agent = AGENTS[name].build(env.env_info)
    observation = env.reset(seed=0, state=start)
    agent.episode_start()
    told = []
    for _ in range(steps):
        told.append(agent.draw_action(observation))
        observation, _, over, _ = env.step(told[-1])
        if over:
            break
    return np.array(told)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("name", "task", "edition", "steps"),
    [
        ("planner", "7dof-defend", "2023", 150),
        ("thesis", "hit_single", "2025", 40),
        ("planner", "7dof-prepare", "2023", 15),
        ("thesis", "7dof-defend", "2023", 25),
        ("thesis", "7dof-prepare", "2023", 40),
        ("hold", "7dof-prepare", "2023", 50),
    ],
)
def test_a_mirrored_situation_is_met_with_the_mirrored_action(
    name: str, task: str, edition: str, steps: int, seed: int
) -> None:
    env = envs.make(task, edition=edition)
    env.reset(seed=seed)
    start = env.base_observation
    here, there = (commands(name, env, state, steps) for state in (start, mirrored(start)))
    assert len(here) == len(there)
    np.testing.assert_allclose(here, there * SIGNS, atol=CLOSE)
