"""A batch as Gymnasium's vector environment.

import airhockey.envs.gymnasium
import gymnasium

vec = gymnasium.make_vec("airhockey/7dof-hit-v0", num_envs=64, threads=2)
"""

from typing import Any, Protocol

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from airhockey.envs.copying import Copyable
from airhockey.envs.environment import Order
from airhockey.envs.vector.environment import Batch, Flags, Seeds, VectorEnvironment
from airhockey.errors import ConfigurationError

Array = NDArray[Any]


class Batched(Protocol):
    """What the adapters of this package need of a batch."""

    num_envs: int

    @property
    def constraint_slices(self) -> dict[str, slice]:
        """Where each constraint's values stand in a row of `Batch.constraints`."""

    @property
    def horizon(self) -> int:
        """Steps after which an episode is truncated."""

    def reset(self, seed: Seeds = None, into: Batch | None = None, which: Flags | None = None) -> Batch:
        """Begin an episode in all or some."""

    def step(self, actions: Any, into: Batch | None = None) -> Batch:
        """Advance all; where an episode ended, the next one has begun."""

    def close(self) -> None:
        """End the threads."""


class BatchVectorEnv(Copyable, VectorEnv[Array, Array, Array]):
    """A batch with one player in each environment.

    Where an episode ended, the observation is the first one of the next, and `infos["final_obs"]` has the last one
    (`AutoresetMode.SAME_STEP`). `infos` holds `success` (and `is_success`, the same under the name that libraries look for)
    and `constraints_value` of the step, arrays over the environments.

    Args:
        batch: What is stepped.
        observation_space, action_space: Of one environment.
        max_episode_steps: May only be the horizon: `gymnasium.make_vec` passes the registered one.

    Attributes:
        batch: The same.
    """

    metadata = {"autoreset_mode": AutoresetMode.SAME_STEP, "render_modes": []}  # noqa: RUF012 - Gymnasium's own way to say so

    def __init__(
        self,
        batch: Batched,
        observation_space: spaces.Box,
        action_space: spaces.Box,
        max_episode_steps: int | None = None,
    ) -> None:
        if max_episode_steps not in (None, batch.horizon):
            raise ConfigurationError(f"an episode has {batch.horizon} steps by the rules, not {max_episode_steps}")
        self.batch, self.num_envs = batch, batch.num_envs
        self.single_observation_space, self.single_action_space = observation_space, action_space
        self.observation_space = batch_space(observation_space, self.num_envs)
        self.action_space = batch_space(action_space, self.num_envs)
        self._all = np.ones(self.num_envs, np.bool_)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begin an episode in every environment, or in those of `options["reset_mask"]`.

        Args:
            seed: An integer s gives environment i the seed s + i; or one for each.
            options: "reset_mask": Shape (N,).
        """
        mask = (options or {}).get("reset_mask")
        if mask is None or not hasattr(self, "_last"):
            self._last = self.batch.reset(seed)
        else:
            kept = self._last.observations.copy()
            self._last = self.batch.reset(seed, self._last, np.asarray(mask, np.bool_))
            self._last.observations[~mask] = kept[~mask]
        return self._last.observations.copy(), {}

    def step(self, actions: Array) -> tuple[Array, Array, Array, Array, dict[str, Any]]:
        """Advance all by one step."""
        self._last = told = self.batch.step(actions)
        ended = told.terminated | told.truncated
        infos: dict[str, Any] = self._infos(told, self._all)
        if ended.any():
            last = np.full(self.num_envs, None, object)
            for i in np.flatnonzero(ended):
                last[i] = told.final_observations[i]
            infos |= {
                "final_obs": last,
                "_final_obs": ended,
                "final_info": self._infos(told, ended),
                "_final_info": ended,
            }
        return told.observations, told.rewards, told.terminated, told.truncated, infos

    def close_extras(self, **kwargs: Any) -> None:
        """End the threads."""
        self.batch.close()

    def _infos(self, told: Batch, which: Flags) -> dict[str, Any]:
        values = {name: told.constraints[:, part] for name, part in self.batch.constraint_slices.items()}
        infos = {"success": told.success.astype(np.int64), "is_success": told.success, "constraints_value": values}
        return infos | {f"_{name}": which for name in infos}


def task_vector_env(
    name: str,
    num_envs: int,
    interpolation_order: Order = 3,
    disturbances: Any = "ideal",
    edition: str = "2023",
    threads: int = 1,
    max_episode_steps: int | None = None,
) -> BatchVectorEnv:
    """A batch of a task, which `gymnasium.make_vec` makes of its id; the arguments are those of `airhockey.envs.make_vec`."""
    batch = VectorEnvironment(name, num_envs, interpolation_order, disturbances, edition, threads)
    if batch.single.n_players == 2:
        raise ConfigurationError(f"{name} has two players; airhockey.envs.make_vec makes a batch of it")
    seen = spaces.Box(-np.inf, np.inf, batch.single.true_observation.shape, np.float64)
    low, high = batch.single.formats[0].limits(batch.single.simulation.robot)
    return BatchVectorEnv(batch, seen, spaces.Box(low, high, dtype=np.float64), max_episode_steps)
