"""What the rewards have in common: the call that MushroomRL's wrapper and the trainers make, and the constraints' term."""

import abc
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.rewards.formulas import normalized_violated_constraints
from airhockey.envs.rewards.situation import native

Array = NDArray[np.float64]


class Reward(abc.ABC):
    """A reward with named terms; called after each step, it notices by itself that a new episode has begun.

    Attributes:
        terms: Name -> value of the latest step; their sum is the reward.
    """

    def __init__(self, constraint_weight: float = 1.0) -> None:
        """Make a reward.

        Args:
            constraint_weight: α of (4.8).
        """
        self._constraint_weight = constraint_weight
        self._expected: Array | None = None
        self.terms: dict[str, float] = {}

    @abc.abstractmethod
    def start(self) -> None:
        """A new episode begins."""

    @abc.abstractmethod
    def task_terms(self, env: Any, state: Array, next_state: Array, absorbing: bool) -> dict[str, float]:
        """The terms of a step besides that of the constraints."""

    def __call__(self, env: Any, state: Array, action: Any, next_state: Array, absorbing: bool) -> float:
        """The reward of the step that the environment has just made.

        Args:
            env: The environment, or the wrapper's base environment.
            state, next_state: Base observations before and after the step, in world coordinates.
            action: Not looked at.
            absorbing: Whether the step ended the episode.
        """
        environment = native(env)
        if self._expected is None or not np.array_equal(state, self._expected):
            self.start()
        self._expected = None if absorbing else next_state
        self.terms = self.task_terms(environment, state, next_state, absorbing)
        self.terms["constraints"] = -self._constraint_weight * self.violation(environment)
        return sum(self.terms.values())

    @staticmethod
    def violation(env: Any) -> float:
        """(4.2) for the latest step."""
        values = env.constraint_values
        if not (values > 0.0).any():  # nearly always, and it is asked at every step
            return 0.0
        by_name = {name: values[part] for name, part in env.constraint_slices.items()}
        return normalized_violated_constraints(by_name, env.edition.penalty_points)
