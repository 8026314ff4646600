"""The one loop: seats at an environment, one or two, step by step."""

import time
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.specs import CONTROL_PERIOD
from airhockey.errors import ActionError, SimulationError
from airhockey.evaluator.play.seat import Seat

Array = NDArray[np.float64]
HUGE = 1e6
"""No command of a robot has entries like this; one that does is what the simulation failed over."""


class Rollout:
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
        self._period, self._next = (CONTROL_PERIOD / real_time if real_time > 0.0 else 0.0), 0.0

    @property
    def failed(self) -> bool:
        """Whether an agent has failed."""
        return any(seat.failure is not None for seat in self.seats)

    def begin(self) -> Any:
        """Begin, with the seed; or serve again, going on with the random streams.

        `episode_start` comes before `reset`, as in the official core.
        """
        for seat in self.seats:
            seat.start()
        seed, self._seed, self.over = self._seed, None, False
        self.observation = self.env.reset(seed=seed)
        self._next = time.perf_counter()
        return self.observation

    def step(self) -> bool:
        """One control step; False where it was not finished, because an agent has failed."""
        self.steps = number = self.steps + 1
        seen, seats = self.observation, self.seats
        if len(seats) == 1:
            seat = seats[0]
            seat.act(seen, number)
            if seat.failure is not None:
                return False
            action: Any = seat.action
        else:
            home, away = seats
            half = seen.size // 2
            home.act(seen[:half].copy(), number)
            away.act(seen[half:].copy(), number)
            if home.failure is not None or away.failure is not None:
                return False
            action = (home.action, away.action)
        try:
            self.observation, self.reward, self.over, self.info = self.env.step(action)
        except (ActionError, SimulationError) as error:
            self._blame(error)
            return False
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

    def _blame(self, error: BaseException) -> None:
        """The simulation failed: over the seat whose command was absurd, or over all."""
        absurd = [seat for seat in self.seats if np.abs(seat.action).max() > HUGE]
        for seat in absurd or self.seats:
            seat.fail(error, self.steps)
