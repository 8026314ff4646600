"""The reward of defend, prepare and home: success at the end, less the constraints' violation (thesis 4.2.2, (4.9))."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.rewards.reward import Reward

Array = NDArray[np.float64]


class TaskReward(Reward):
    """B for a success and −P for a failure when the episode is over, and (4.2) subtracted at every step.

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
