"""What the tasks' rewards have in common: the call that wrapper and trainers make, the constraints' term, success or failure."""

import abc
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.tasks.positions import native

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

    def get_state(self) -> dict[str, Any]:
        """What the next rewards depend on besides the environment."""
        return dict(self.__dict__)

    def set_state(self, state: dict[str, Any]) -> None:
        """Go back to what was saved, of this reward or one like it."""
        self.__dict__.update(state)

    @staticmethod
    def violation(env: Any) -> float:
        """(4.2) for the latest step."""
        values = env.constraint_values
        if not (values > 0.0).any():  # nearly always, and it is asked at every step
            return 0.0
        by_name = {name: values[part] for name, part in env.constraint_slices.items()}
        return normalized_violated_constraints(by_name, env.edition.penalty_points)


class RewardedState(NamedTuple):
    """A moment of an environment and of its reward, if that is one of this package."""

    environment: Any
    reward: dict[str, Any] | None

    @classmethod
    def of(cls, env: Any, reward: Any) -> "RewardedState":
        """The present moment of both."""
        return cls(env.get_state(), reward.get_state() if isinstance(reward, Reward) else None)

    def restore(self, env: Any, reward: Any) -> None:
        """Take both back to it."""
        env.set_state(self.environment)
        if self.reward is not None and isinstance(reward, Reward):
            reward.set_state(self.reward)


class TaskReward(Reward):
    """B for a success and −P for a failure when the episode is over, and (4.2) subtracted at every step (4.2.2, (4.9)).

    | term | when | value |
    |---|---|---|
    | success | the episode ends, and the task is accomplished | B |
    | failure | the episode ends, and it is not | −P |
    | constraints | every step | −(4.2) |
    """

    def __init__(
        self,
        success_bonus: float = 1000.0,
        failure_penalty: float = 100.0,
        accomplished: Callable[[Any], bool] | None = None,
    ) -> None:
        """Make the reward.

        Args:
            success_bonus: B.
            failure_penalty: P.
            accomplished: Says of the environment whether the task is; by default what its referee says.
        """
        super().__init__()
        self._bonus, self._penalty, self._accomplished = success_bonus, failure_penalty, accomplished

    def start(self) -> None:
        """See `Reward.start`."""

    def task_terms(self, env: Any, state: Array, next_state: Array, absorbing: bool) -> dict[str, float]:
        """See `Reward.task_terms`."""
        if not absorbing and env.step_count < env.horizon:
            return {}
        accomplished = env.succeeded if self._accomplished is None else self._accomplished(env)
        return {"success": self._bonus} if accomplished else {"failure": -self._penalty}


def normalized_violated_constraints(values: Mapping[str, Array], penalty_points: Mapping[str, float]) -> float:
    """(4.2): Σᵢ φᵢ (1/N Σⱼ σⱼ) / Σᵢ φᵢ.

    i runs over the constraints of the robot; σⱼ are the positive slacks (4.3) of constraint i and N is their number, so
    that a constraint counts by how far it is violated and not by how many joints it has. A constraint that holds adds
    nothing to the numerator; its φᵢ stays in the denominator, or a single violated one would lose its weight.

    Args:
        values: Constraint name -> current value less limit, violated where positive. Shapes (c,).
        penalty_points: Constraint name -> φ.
    """
    weighted = sum(penalty_points[name] * mean_violation(slack) for name, slack in values.items())
    return weighted / sum(penalty_points[name] for name in values)


def mean_violation(slack: Array) -> float:
    """Mean of the positive entries; 0 where there is none."""
    violated = slack[slack > 0.0]
    return float(violated.mean()) if violated.size else 0.0
