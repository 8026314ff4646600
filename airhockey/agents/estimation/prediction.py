"""Where the puck will be: at a time, with the covariance of the answer; on a line; along a path."""

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.estimation.kalman import MotionModel, PuckEstimate, motion_model, predict
from airhockey.agents.estimation.motion import PuckMotion, advance, puck_motion
from airhockey.envs.compiled import pack

Array = NDArray[np.float64]


class Crossing(NamedTuple):
    """The puck's passage of a line x = constant.

    Attributes:
        time: From now, in [s].
        state: Then: x, y, ẋ, ẏ, yaw rate. Shape (5,).
    """

    time: float
    state: Array


class PuckPredictor:
    """Predicts from an estimate. Cheap: tens of microseconds for a second of flight."""

    def __init__(self, step: float = 0.01, drift_velocity: float = 0.004, motion: PuckMotion | None = None) -> None:
        """Compile.

        Args:
            step: Resolution of the prediction, in [s].
            drift_velocity: Uncertainty that a step adds to each velocity, in [m]/[s].
            motion: Constants of the puck's motion.
        """
        self._step = step
        self._model = pack(motion_model(motion or puck_motion()))
        self._drift = np.diag([0.0, 0.0, drift_velocity, drift_velocity, 0.1]) ** 2
        still = PuckEstimate(np.array([0.0, 0.0, 1.0, 0.0, 0.0]), np.eye(5), 0)
        self.at_time(still, 2 * step)
        self.at_line(still, 0.1, 0.5)
        self.path(still, 2 * step)

    def at_time(self, estimate: PuckEstimate, time: float) -> tuple[Array, Array]:
        """State and covariance after a time, in [s]. Shapes (5,), (5, 5)."""
        return carried(estimate.state, estimate.covariance, self._steps(time), self._step, self._drift, self._model)

    def path(self, estimate: PuckEstimate, time: float) -> Array:
        """States at every `step` from now to a time. Shape (k + 1, 5)."""
        return coast(estimate.state, self._step, self._steps(time), self._model)

    def at_line(self, estimate: PuckEstimate, x: float, time: float) -> Crossing | None:
        """The first passage of the line at x (from either side) within a time, or None.

        Args:
            estimate: What is known of the puck now.
            x: In the table frame, in [m].
            time: Horizon, in [s].
        """
        state = np.empty(5)
        when = passage(estimate.state, x, self._step, self._steps(time), self._model, state)
        return Crossing(when, state) if when >= 0.0 else None

    def _steps(self, time: float) -> int:
        return max(1, round(time / self._step))


@cache
def puck_predictor() -> PuckPredictor:
    """The one that players ask, with the identified constants."""
    return PuckPredictor()


@compiled
def coast(state: Array, step: float, steps: int, packed: NDArray[Any]) -> Array:
    """States at every step [s] from now, bounces included. Shape (steps + 1, 5)."""
    states = np.empty((steps + 1, 5))
    states[0] = state
    for i in range(steps):
        states[i + 1] = states[i]
        advance(states[i + 1], step, packed[0].constants)
    return states


@compiled
def passage(state: Array, x: float, step: float, steps: int, packed: NDArray[Any], there: Array) -> float:
    """When a puck first passes the line at x, in [s], linear between the steps; −1 if it does not, or lies on the line.

    Args:
        state: Now. Shape (5,).
        x: In [m].
        step, steps: Resolution, in [s], and how many of these are looked ahead.
        packed: A record of a `MotionModel`.
        there: Where its state then is written. Shape (5,).
    """
    constants, before, after = packed[0].constants, state.copy(), state.copy()
    for k in range(steps):
        before[:] = after
        advance(after, step, constants)
        side, other = before[0] - x, after[0] - x
        if side * other <= 0.0:
            share = side / (side - other) if side != other else 0.0
            there[:] = (1.0 - share) * before + share * after
            return (
                (k + share) * step
                if side != 0.0 or other != 0.0 or _leaves(after, x, step, steps - k - 1, constants)
                else -1.0
            )
    return -1.0


@compiled
def _leaves(state: Array, x: float, step: float, steps: int, constants: Array) -> bool:
    """Whether a puck on the line at x is elsewhere at one of the coming steps."""
    for _ in range(steps):
        advance(state, step, constants)
        if state[0] != x:
            return True
    return False


@compiled
def carried(
    state: Array, covariance: Array, steps: int, step: float, drift: Array, packed: NDArray[Any]
) -> tuple[Array, Array]:
    """State and covariance after so many steps, in [s]. Shapes (5,), (5, 5)."""
    model = MotionModel(packed[0].constants, packed[0].e_spread, packed[0].k_spread)
    for _ in range(steps):
        state, covariance = predict(state, covariance, step, drift, model)
    return state, covariance
