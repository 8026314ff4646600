"""The one loop: seats at an environment, one or two, step by step."""

import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from airhockey.envs.copying import NotCopyable
from airhockey.envs.specs import CONTROL_PERIOD
from airhockey.evaluator.play.blame import fault_of, fault_of_observation, guilty_of
from airhockey.evaluator.play.seat import Seat


class Rollout(NotCopyable):
    """An episode of a task, or a game, as it goes on.

    Args:
        env: The environment.
        seats: One for each of its players.
        seed: The environment's.
        real_time: Pace of the steps relative to the robot's; 0 for as fast as possible.

    Attributes:
        observation: The latest one; in a game both players' in a row. Shape (d,).
        steps: Control steps begun; an agent's failure leaves the last one unfinished.
        reward: Of the latest step.
        over: Whether the latest step ended the episode, or in a game the serve.
        info: What the environment tells of the latest step.
    """

    def __init__(self, env: Any, seats: Sequence[Seat], seed: Any, real_time: float = 0.0) -> None:
        self.env, self.seats, self._seed = env, seats, seed
        self.observation: Any = None
        self.steps, self.reward, self.over = 0, 0.0, False
        self.info: dict[str, Any] = {}
        self._before = tuple(seat.action for seat in seats)
        self._period, self._next = (CONTROL_PERIOD / real_time if real_time > 0.0 else 0.0), 0.0

    @property
    def failed(self) -> bool:
        """Whether an agent has failed."""
        return any(seat.failure is not None for seat in self.seats)

    def begin(self) -> Any:
        """Begin, with the seed; or serve again, going on with the random streams.

        `episode_start` comes before `reset`, as in the official core.

        Raises:
            EnvironmentFault: The environment failed.
        """
        for seat in self.seats:
            seat.start()
        seed, self._seed, self.over = self._seed, None, False
        try:
            self.observation = self.env.reset(seed=seed)
        except Exception as error:
            raise fault_of(self.env, error, 0) from error
        self._next = time.perf_counter()
        return self.observation

    def step(self) -> bool:
        """One control step; False where it was not finished, because an agent has failed.

        Raises:
            EnvironmentFault: The simulation failed, and over nobody's command; or an agent, over an impossible observation.
        """
        self.steps = number = self.steps + 1
        seen, seats = self.observation, self.seats
        if len(seats) == 1:
            seat = seats[0]
            seat.act(seen.copy(), number)
            if seat.failure is not None:
                return self._failed(number)
            action: Any = seat.action
        else:
            home, away = seats
            half = seen.size // 2
            home.act(seen[:half].copy(), number)
            away.act(seen[half:].copy(), number)
            if home.failure is not None or away.failure is not None:
                return self._failed(number)
            action = (home.action, away.action)
        try:
            self.observation, self.reward, self.over, self.info = self.env.step(action)
        except Exception as error:
            self._blame(error)
            return False
        self._before = action if len(seats) == 2 else (action,)
        if self._period:
            self._keep_pace()
        return True

    def _keep_pace(self) -> None:
        """Wait for the end of the control step; time that was lost is not made up for."""
        self._next += self._period
        left = self._next - time.perf_counter()
        if left > 0.0:
            time.sleep(left)
        else:
            self._next -= left

    def _failed(self, step: int) -> bool:
        """An agent did, unless what it saw was impossible; an agent that is gone saw nothing."""
        if not np.isfinite(self.observation).all():
            raise fault_of_observation(self.env, step)
        return False

    def _blame(self, error: Exception) -> None:
        """The simulation failed: over the seats whose command was absurd, or over nobody's."""
        guilty = guilty_of(self.seats, self._before)
        if not guilty:
            raise fault_of(self.env, error, self.steps) from error
        for seat in guilty:
            seat.fail(error, self.steps)
