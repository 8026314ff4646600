"""Everything that happens in an episode of a task, kept for the judge and for those who look at it later."""

from typing import Any

import numpy as np

from airhockey.evaluator.runs.records import Trajectory


class Recorder:
    """Buffers for one episode, reused from episode to episode. `trajectory()` says what they hold."""

    def __init__(self, env: Any, observation_size: int, disturbed: bool) -> None:
        """Allocate buffers for an environment.

        Args:
            env: Has `horizon`, `constraint_slices`, `constraint_values` and `true_observation`.
            observation_size: Number of entries of an observation.
            disturbed: Whether the agent may see something else than what is judged.
        """
        self.horizon = int(env.horizon)
        self.steps = 0
        self.constraint_slices: dict[str, slice] = dict(env.constraint_slices)
        self.constraint_values = np.empty((self.horizon, env.constraint_values.size))
        self._env = env
        self._disturbed = disturbed
        self._observations = np.empty((self.horizon + 1, observation_size))
        self._true_observations = np.empty((self.horizon + 1, observation_size))
        self._actions = np.empty((self.horizon, *env.formats[0].shape))
        self._rewards = np.empty(self.horizon)
        self._computation_time = np.empty(self.horizon)

    def start(self, observation: Any) -> None:
        """A new episode begins, with this observation."""
        self.steps = 0
        self._observations[0] = observation
        if self._disturbed:
            self._true_observations[0] = self._env.true_observation

    def add(self, action: Any, reward: float, seconds: float, observation: Any) -> None:
        """Keep one step: the action, the time in [s] that it took, and what came of it."""
        step = self.steps
        self._actions[step] = action
        self._rewards[step] = reward
        self._computation_time[step] = seconds
        self.constraint_values[step] = self._env.constraint_values
        self._observations[step + 1] = observation
        if self._disturbed:
            self._true_observations[step + 1] = self._env.true_observation
        self.steps = step + 1

    def trajectory(self) -> Trajectory:
        """Copies of what was kept, by name.

        Returns:
            `observations`, as the agent was given them, and `true_observations` where they may differ, (T + 1, d);
            `actions`, by interpolation order, (T, …); `rewards` (T,); `computation_time` (T,) in [s];
            `constraints/<name>` (T, c), violated where > 0.
        """
        steps = self.steps
        kept = {"observations": self._observations[: steps + 1].copy()}
        if self._disturbed:
            kept["true_observations"] = self._true_observations[: steps + 1].copy()
        kept["actions"] = self._actions[:steps].copy()
        kept["rewards"] = self._rewards[:steps].copy()
        kept["computation_time"] = self._computation_time[:steps].copy()
        for name, columns in self.constraint_slices.items():
            kept[f"constraints/{name}"] = self.constraint_values[:steps, columns].copy()
        return kept


def violated_steps(constraint_values: Any, slices: dict[str, slice]) -> dict[str, int]:
    """Constraint name -> number of steps that violated it.

    Args:
        constraint_values: Violated where > 0. Shape (T, c).
        slices: Constraint name -> its columns.
    """
    violated = constraint_values > 0.0
    return {name: int(violated[:, columns].any(axis=1).sum()) for name, columns in slices.items()}
