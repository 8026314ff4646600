"""A batch as Stable-Baselines3's `VecEnv`.

import gymnasium
from stable_baselines3 import PPO

import airhockey.envs.gymnasium
from airhockey.envs.vector.stable_baselines3 import BatchVecEnv

vec = BatchVecEnv(gymnasium.make_vec("airhockey/7dof-hit-v0", num_envs=64, threads=2))
PPO("MlpPolicy", vec).learn(1_000_000)
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.copying import Copyable
from airhockey.envs.vector.gymnasium import BatchVectorEnv
from airhockey.inputs.packages import needs

with needs("this interface", "Stable-Baselines3", "rl"):
    from stable_baselines3.common.vec_env import VecEnv

Array = NDArray[Any]


class BatchVecEnv(Copyable, VecEnv):
    """The adapter.

    It counts episodes itself, as `VecMonitor` would: where one ended, `info` holds `episode` (return and length),
    `is_success`, `terminal_observation` and `TimeLimit.truncated`.

    Args:
        env: A batch of tasks; what `gymnasium.make_vec` made of one of this package's ids.
    """

    def __init__(self, env: Any) -> None:
        self.env: BatchVectorEnv = env.unwrapped
        self._returns = np.zeros(self.env.num_envs)
        self._lengths = np.zeros(self.env.num_envs, np.int64)
        super().__init__(self.env.num_envs, self.env.single_observation_space, self.env.single_action_space)

    def seed_from(self, seeds: Any) -> None:
        """Have the next reset begin with these seeds, one for each environment: integers or seed sequences."""
        self._seeds = list(seeds)

    def get_state(self) -> tuple[Any, ...]:
        """The present moment of the batch and of the episodes' counts."""
        batch: Any = self.env.batch
        return batch.get_state(), self._returns.copy(), self._lengths.copy()

    def set_state(self, state: tuple[Any, ...]) -> None:
        """Go to a moment that this adapter, or one of a batch made with the same arguments, saved."""
        batch: Any = self.env.batch
        batch.set_state(state[0])
        self._returns[:], self._lengths[:] = state[1:]

    def reset(self) -> Array:
        """Begin an episode in every environment, with the seeds given before, if any."""
        observations, _ = self.env.reset(seed=list(self._seeds))
        self._returns[:], self._lengths[:] = 0.0, 0
        self.reset_infos = [{} for _ in range(self.num_envs)]
        self._reset_seeds()
        self._reset_options()
        return observations

    def step_async(self, actions: Array) -> None:
        """Keep the actions for `step_wait`."""
        self._waiting = actions

    def step_wait(self) -> tuple[Array, Array, Array, list[dict[str, Any]]]:
        """Advance all by one step."""
        observations, rewards, terminated, truncated, told = self.env.step(self._waiting)
        self._returns += rewards
        self._lengths += 1
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        done = terminated | truncated
        for i in np.flatnonzero(done):
            infos[i] = {
                "episode": {"r": float(self._returns[i]), "l": int(self._lengths[i]), "t": 0.0},
                "is_success": bool(told["is_success"][i]),
                "terminal_observation": told["final_obs"][i],
                "TimeLimit.truncated": bool(truncated[i]),
            }
            self._returns[i], self._lengths[i] = 0.0, 0
        return observations, rewards.astype(np.float32), done, infos

    def close(self) -> None:
        """End the threads."""
        self.env.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """An attribute of the batch, which is that of each of its environments."""
        return [getattr(self.env, attr_name)] * len(self._chosen(indices))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Not for a batch: its environments share everything."""
        raise AttributeError(f"{attr_name!r} cannot be set in some environments of a batch; make the batch with it")

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """Not for a batch: its environments have no methods of their own."""
        raise AttributeError(
            f"a batch's environments have no method {method_name!r}; see `env.batch.environment(index)`"
        )

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Whether episodes are counted, which is what is asked for with `Monitor`; nothing else wraps them."""
        return [wrapper_class.__name__ == "Monitor"] * len(self._chosen(indices))

    def _chosen(self, indices: Any) -> Sequence[int]:
        return list(self._get_indices(indices))
