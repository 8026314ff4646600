"""The learner's environments under Gymnasium's names: `airhockey/<task>-<actions>-v0`.

    import airhockey.learning.envs.gymnasium
    import gymnasium

    vec = gymnasium.make_vec("airhockey/7dof-defend-tip-v0", num_envs=16, threads=2)
    env = gymnasium.make("airhockey/7dof-hit-mallet-v0", disturbances="server")

    games = gymnasium.make_vec("airhockey/tournament-tip-v0", num_envs=8, opponents=["planner", "thesis"])

Tasks are those of `airhockey.envs.gymnasium` of 2023, actions those of `airhockey.agents.learned.actions`. An observation is
what `features` says, a reward what `rewards` says, and both can be chosen: see `LearningBatch`; for games see `GameBatch`.
"""

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from airhockey.agents.learned.actions import ACTIONS
from airhockey.agents.learned.features import LARGEST
from airhockey.envs.editions import edition
from airhockey.envs.gymnasium import NAMESPACES, TASKS
from airhockey.envs.vector.gymnasium import BatchVectorEnv
from airhockey.learning.envs.batch import LearningBatch
from airhockey.learning.envs.game import GameBatch

Array = NDArray[Any]

YEAR, REPEAT, GAME = "2023", 2, "tournament"


def learning_vector_env(
    name: str, num_envs: int, max_episode_steps: int | None = None, **choice: Any
) -> BatchVectorEnv:
    """A batch of a task, as Gymnasium's vector environment; `choice` is that of `LearningBatch`."""
    batch = _batch(name, num_envs, **choice)
    longest = max_episode_steps if name == GAME or choice.get("repeat", REPEAT) == REPEAT else None
    return BatchVectorEnv(batch, *spaces_of(batch), longest)


class LearningEnv(gymnasium.Env[Array, Array]):
    """A single one of them: a batch of one.

    Args:
        name: Of the task.
        choice: See `LearningBatch`.

    Attributes:
        batch: The batch of one.
    """

    metadata = {"render_modes": []}  # noqa: RUF012 - Gymnasium's own way to say so

    def __init__(self, name: str, **choice: Any) -> None:
        self.batch = _batch(name, 1, **choice)
        self.observation_space, self.action_space = spaces_of(self.batch)
        self._begun: Array | None = None

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        """Begin an episode; without a seed the one that follows, as in a batch."""
        super().reset(seed=seed)
        begun, self._begun = self._begun, None
        if seed is None and begun is not None:
            return begun, {}
        return self.batch.reset(seed).observations[0], {}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Let an action last for its control steps."""
        told = self.batch.step(np.asarray(action)[None])
        terminated, truncated = bool(told.terminated[0]), bool(told.truncated[0])
        self._begun = told.observations[0] if terminated or truncated else None
        success = bool(told.success[0])
        values = {name: told.constraints[0, part] for name, part in self.batch.constraint_slices.items()}
        info = {"success": int(success), "is_success": success, "constraints_value": values}
        return told.final_observations[0], float(told.rewards[0]), terminated, truncated, info


def _batch(name: str, num_envs: int, **choice: Any) -> LearningBatch:
    return GameBatch(num_envs, **choice) if name == GAME else LearningBatch(name, num_envs, **choice)


def spaces_of(batch: LearningBatch) -> tuple[spaces.Box, spaces.Box]:
    """Observation and action of one environment."""
    if batch.new_batch().observations.dtype == np.float32:
        seen: Any = spaces.Box(-LARGEST, LARGEST, (batch.observation_width,), np.float32)
    else:
        seen = spaces.Box(-np.inf, np.inf, (batch.observation_width,), np.float64)
    return seen, spaces.Box(-1.0, 1.0, batch.action_shape, np.float32)


def register() -> None:
    """Register every task with every kind of actions, once."""
    horizon = edition(YEAR).horizon
    for name in (*TASKS[YEAR], GAME):
        longest = horizon.game if name == GAME else -(-horizon.task // REPEAT)
        for kind in ACTIONS:
            id_ = f"{NAMESPACES[YEAR]}/{name}-{kind}-v0"
            if id_ not in gymnasium.registry:
                gymnasium.register(
                    id_,
                    entry_point=f"{__name__}:LearningEnv",
                    vector_entry_point=f"{__name__}:learning_vector_env",
                    max_episode_steps=longest,
                    kwargs={"name": name, "actions": kind},
                )


register()
