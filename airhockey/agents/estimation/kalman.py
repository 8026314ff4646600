"""A Kalman filter of the puck that knows its damping and its bounces, and rides out a lost track.

State and frame are those of `airhockey.agents.estimation.motion`. Observed are position, velocity and yaw rate, all
five.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.estimation.motion import PuckMotion, puck_motion, transition

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Noise:
    """Standard deviations that the filter assumes.

    Attributes:
        position, velocity, yaw_rate: Of the observation, in [m], [m]/[s], [rad]/[s]. The defaults are those of the
            profile `server`.
        drift_velocity, drift_yaw_rate: What one step adds to the truth's uncertainty, in the same units.
        drift_share: What one step adds per speed of the puck, because its damping is not known exactly; without unit.
        contact_velocity, contact_yaw_rate: The same while a mallet may be touching the puck.
        surprise: Squared Mahalanobis distance of an observation beyond which something has hit the puck.
    """

    position: float = 0.002
    velocity: float = 0.05
    yaw_rate: float = 0.5
    drift_velocity: float = 0.004
    drift_yaw_rate: float = 0.1
    drift_share: float = 0.0
    contact_velocity: float = 0.5
    contact_yaw_rate: float = 10.0
    surprise: float = 30.0


@dataclass(frozen=True)
class PuckEstimate:
    """What is known of the puck at one moment, in the table frame.

    Attributes:
        state: x, y [m], ẋ, ẏ [m]/[s], yaw rate [rad]/[s]. Shape (5,).
        covariance: Of the state. Shape (5, 5).
        lost: For how many steps the track has been lost.
    """

    state: Array
    covariance: Array
    lost: int

    @property
    def position(self) -> Array:
        """In [m]. Shape (2,)."""
        return self.state[:2]

    @property
    def velocity(self) -> Array:
        """In [m]/[s]. Shape (2,)."""
        return self.state[2:4]

    @property
    def speed(self) -> float:
        """In [m]/[s]."""
        return float(np.hypot(self.state[2], self.state[3]))


class PuckFilter:
    """Feeds on one observation per control step. `update` gives the estimate at the time of that observation."""

    LONGEST_LOSS = 15
    """Steps after which a repeated observation is believed again: the puck really lies still there."""
    STILL = 0.03
    """Below this predicted speed, in [m]/[s], zero observed velocities are no sign of a lost track."""

    def __init__(self, dt: float = 0.02, noise: Noise | None = None, motion: PuckMotion | None = None) -> None:
        """Compile, and wait for the first observation.

        Args:
            dt: Time between observations, in [s].
            noise: What the filter assumes.
            motion: Constants of the puck's motion.
        """
        self._dt = dt
        self._noise = noise or Noise()
        self._motion = motion or puck_motion()
        self._constants = self._motion.constants
        n = self._noise
        self._observation_covariance = np.diag([n.position, n.position, n.velocity, n.velocity, n.yaw_rate]) ** 2
        self._drift = np.diag([1e-5, 1e-5, n.drift_velocity, n.drift_velocity, n.drift_yaw_rate]) ** 2
        self._contact = np.diag([1e-3, 1e-3, n.contact_velocity, n.contact_velocity, n.contact_yaw_rate]) ** 2
        self.reset()
        for k in range(3):  # compile before the game
            self.update(np.array([0.02 * k, 0.0, 0.0]), np.array([1.0, 0.0, 0.0]))
        self.reset()

    def reset(self) -> None:
        """Forget the puck."""
        self._last: Array | None = None
        self._lost = 0
        self.estimate = PuckEstimate(np.zeros(5), np.eye(5), 0)

    def update(self, position: Array, velocity: Array, contact: bool = False) -> PuckEstimate:
        """Take one observation.

        Args:
            position: Puck's x, y (and yaw, unused) in the table frame. Shape (2,) or (3,).
            velocity: Puck's ẋ, ẏ and yaw rate. Shape (3,).
            contact: A mallet is so near that it may be touching the puck.

        Returns:
            The estimate now.
        """
        seen = np.array([position[0], position[1], velocity[0], velocity[1], velocity[2]])
        if self._last is None:
            self._last = seen
            self.estimate = PuckEstimate(seen, self._observation_covariance.copy(), 0)
            return self.estimate
        before = self.estimate
        state, covariance = predict(
            before.state, before.covariance, self._dt, self._constants,
            self._contact if contact else self._drift_at(before.speed),
            self._motion.restitution_spread, self._motion.slip_spread,
        )  # fmt: skip
        self._lost = self._lost + 1 if self._is_lost(seen, state) else 0
        self._last = seen
        if self._lost == 0 or self._lost > self.LONGEST_LOSS:
            state, covariance = correct(
                state, covariance, seen, self._observation_covariance, self._contact, self._noise.surprise
            )
        self.estimate = PuckEstimate(state, covariance, self._lost)
        return self.estimate

    def _drift_at(self, speed: float) -> Array:
        """Covariance that one step adds at a speed. Shape (5, 5)."""
        drift = self._drift.copy()
        drift[2, 2] = drift[3, 3] = drift[2, 2] + (self._noise.drift_share * speed) ** 2
        return drift

    def _is_lost(self, seen: Array, predicted: Array) -> bool:
        """A lost track shows the previous observation again, or no velocity at all where the puck should be moving."""
        repeated = self._last is not None and bool(np.array_equal(seen, self._last))
        moving = bool(np.hypot(predicted[2], predicted[3]) > self.STILL)
        return repeated or (moving and not seen[2:].any())


@compiled
def predict(
    state: Array, covariance: Array, duration: float, constants: Array, drift: Array, e_spread: float, k_spread: float
) -> tuple[Array, Array]:
    """Carry mean and covariance over a duration; a bounce adds what is uncertain about it. Shapes (5,), (5, 5)."""
    after, jacobian, bounces = transition(state, duration, constants)
    spread = jacobian @ covariance @ jacobian.T + drift
    if bounces > 0:
        spread[0, 0] += 0.002**2
        spread[1, 1] += 0.002**2
        for i in range(2, 4):
            spread[i, i] += (e_spread * state[i]) ** 2 + (k_spread * state[i]) ** 2 + 0.02**2
        spread[4, 4] += (2.0 * k_spread * (abs(state[2]) + abs(state[3])) / constants[7]) ** 2 + 1.0
    return after, spread


@compiled
def correct(
    state: Array, covariance: Array, seen: Array, observation_covariance: Array, contact: Array, surprise: float
) -> tuple[Array, Array]:
    """The Kalman update; an observation that surprises first widens the prediction. Shapes (5,), (5, 5)."""
    innovation = seen - state
    spread = covariance + observation_covariance
    if innovation @ np.linalg.solve(spread, innovation) > surprise:
        covariance = covariance + contact
        covariance[0, 0] += innovation[0] ** 2
        covariance[1, 1] += innovation[1] ** 2
        spread = covariance + observation_covariance
    gain = np.linalg.solve(spread, covariance).T
    keep = np.eye(5) - gain
    return state + gain @ innovation, keep @ covariance @ keep.T + gain @ observation_covariance @ gain.T
