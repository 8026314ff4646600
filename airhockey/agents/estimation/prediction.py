"""Where the puck will be: at a time, on a line, along a path; with the covariance of the answer."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.estimation.kalman import PuckEstimate, motion_model, predict
from airhockey.agents.estimation.motion import PuckMotion, puck_motion
from airhockey.envs.compiled import pack

Array = NDArray[np.float64]


class Crossing(NamedTuple):
    """The puck's passage of a line x = constant.

    Attributes:
        time: From now, in [s].
        state: Then: x, y, ẋ, ẏ, yaw rate. Shape (5,).
        covariance: Of that state. Shape (5, 5).
    """

    time: float
    state: Array
    covariance: Array


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
        states, covariances = self._run(estimate, time)
        return states[-1], covariances[-1]

    def path(self, estimate: PuckEstimate, time: float) -> Array:
        """States at every `step` from now to a time. Shape (k + 1, 5)."""
        return np.asarray(self._run(estimate, time)[0])

    def at_line(self, estimate: PuckEstimate, x: float, time: float) -> Crossing | None:
        """The first passage of the line at x (from either side) within a time, or None.

        Args:
            estimate: What is known of the puck now.
            x: In the table frame, in [m].
            time: Horizon, in [s].
        """
        states, covariances = self._run(estimate, time)
        side = states[:, 0] - x
        crossings = np.flatnonzero(side[:-1] * side[1:] <= 0.0)
        if len(crossings) == 0 or not side.any():
            return None
        k = int(crossings[0])
        share = float(side[k] / (side[k] - side[k + 1])) if side[k] != side[k + 1] else 0.0
        mix = (1.0 - share) * states[k] + share * states[k + 1]
        return Crossing((k + share) * self._step, mix, (1.0 - share) * covariances[k] + share * covariances[k + 1])

    def _run(self, estimate: PuckEstimate, time: float) -> tuple[Array, Array]:
        steps = max(1, round(time / self._step))
        return _run(estimate.state, estimate.covariance, steps, self._step, self._drift, self._model)


@compiled
def _run(
    state: Array, covariance: Array, steps: int, step: float, drift: Array, packed: NDArray[Any]
) -> tuple[Array, Array]:
    """States and covariances at every step [s] from now. Shapes (steps + 1, 5), (steps + 1, 5, 5)."""
    states, covariances = np.empty((steps + 1, 5)), np.empty((steps + 1, 5, 5))
    states[0], covariances[0] = state, covariance
    for i in range(steps):
        states[i + 1], covariances[i + 1] = predict(states[i], covariances[i], step, drift, packed[0])
    return states, covariances
