"""A Kalman filter of the puck that knows its damping and its bounces, and rides out a lost track.

State and frame are those of `airhockey.agents.estimation.motion`. Observed are position, velocity and yaw rate, all
five.
"""

from dataclasses import dataclass
from math import hypot, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.estimation.motion import PuckMotion, puck_motion, transition
from airhockey.agents.small_matrices import add_congruence, factor, solve_backward, solve_forward
from airhockey.envs.compiled import pack

Array = NDArray[np.float64]

LONGEST_LOSS = 15
"""Steps after which a repeated observation is believed again: the puck really lies still there."""
STILL = 0.03
"""Below this predicted speed, in [m]/[s], zero observed velocities are no sign of a lost track."""


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


class PuckEstimate(NamedTuple):
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
        return hypot(self.state[2], self.state[3])


class MotionModel(NamedTuple):
    """What a prediction is computed from; see `PuckMotion`.

    Attributes:
        constants: `PuckMotion.constants`. Shape (8,).
        e_spread, k_spread: Standard deviations of restitution and slip.
    """

    constants: Array
    e_spread: float
    k_spread: float


def motion_model(motion: PuckMotion) -> MotionModel:
    """The model of a puck's motion."""
    return MotionModel(motion.constants, motion.restitution_spread, motion.slip_spread)


class FilterModel(NamedTuple):
    """What a step of the filter is computed from besides `MotionModel`; see `Noise`.

    Attributes:
        dt: Time between observations, in [s].
        observation: Covariance of an observation. Shape (5, 5).
        drift, contact: Covariance that a step adds, and what it adds where a mallet may touch the puck. Shapes (5, 5).
    """

    dt: float
    observation: Array
    drift: Array
    contact: Array
    drift_share: float
    surprise: float


class Track(NamedTuple):
    """What the filter remembers from one observation to the next.

    Attributes:
        state, covariance, lost: The latest estimate. Shapes (5,), (5, 5).
        last: The latest observation. Shape (5,).
        begun: Whether there was one.
    """

    state: Array
    covariance: Array
    lost: int
    last: Array
    begun: bool


def filter_record(
    dt: float, noise: Noise | None = None, motion: PuckMotion | None = None, *more: NamedTuple
) -> NDArray[Any]:
    """All that `follow` reads and remembers, as a record: `MotionModel`, `FilterModel`, `Track` and the caller's own parts.

    Args:
        dt: Time between observations, in [s].
        noise: What the filter assumes.
        motion: Constants of the puck's motion.
        more: Other fields that the record shall have.
    """
    n = noise or Noise()
    model = FilterModel(
        dt=dt,
        observation=np.diag([n.position, n.position, n.velocity, n.velocity, n.yaw_rate]) ** 2,
        drift=np.diag([1e-5, 1e-5, n.drift_velocity, n.drift_velocity, n.drift_yaw_rate]) ** 2,
        contact=np.diag([1e-3, 1e-3, n.contact_velocity, n.contact_velocity, n.contact_yaw_rate]) ** 2,
        drift_share=n.drift_share,
        surprise=n.surprise,
    )
    track = Track(np.zeros(5), np.eye(5), 0, np.zeros(5), False)
    return pack(motion_model(motion or puck_motion()), model, track, *more)


class PuckFilter:
    """Feeds on one observation per control step. `update` gives the estimate at the time of that observation."""

    def __init__(self, dt: float = 0.02, noise: Noise | None = None, motion: PuckMotion | None = None) -> None:
        """Compile, and wait for the first observation. The arguments are those of `filter_record`."""
        self._record = filter_record(dt, noise, motion)
        for k in range(3):  # compile before the game
            self.update(np.array([0.02 * k, 0.0, 0.0]), np.array([1.0, 0.0, 0.0]))
        self.reset()

    def reset(self) -> None:
        """Forget the puck."""
        self._record["begun"] = False

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
        now = np.empty((6, 5))
        lost = follow(self._record, seen, contact, now)
        return PuckEstimate(now[0], now[1:], lost)


@compiled
def follow(record: NDArray[Any], seen: Array, contact: bool, now: Array) -> int:
    """One step of the filter: predict, and correct by the observation unless the track is lost.

    Args:
        record: From `filter_record`; its `Track` is brought up to date.
        seen: The observation, laid out like the state. Shape (5,).
        contact: A mallet may be touching the puck.
        now: Where the estimate is written, the state above the covariance: to give an array back costs more. Shape (6, 5).

    Returns:
        For how many steps the track has been lost.
    """
    r = record[0]
    motion = MotionModel(r.constants, r.e_spread, r.k_spread)
    model = FilterModel(r.dt, r.observation, r.drift, r.contact, r.drift_share, r.surprise)
    lost = 0
    if r.begun:
        drift = _drift(r.state, contact, model)
        state, covariance = predict(r.state, r.covariance, model.dt, drift, motion)
        if _is_lost(seen, r.last, state):
            lost = r.lost + 1
        if lost == 0 or lost > LONGEST_LOSS:
            state, covariance = correct(state, covariance, seen, model)
    else:
        state, covariance = seen.copy(), model.observation.copy()
    now[0], now[1:] = state, covariance
    r.state[:], r.covariance[:], r.last[:] = state, covariance, seen
    r.lost, r.begun = lost, True
    return lost


@compiled
def _drift(state: Array, contact: bool, model: FilterModel) -> Array:
    """Covariance that a step adds. Shape (5, 5)."""
    if contact:
        return np.asarray(model.contact.copy())
    drift = model.drift.copy()
    slipping = (model.drift_share * sqrt(state[2] * state[2] + state[3] * state[3])) ** 2
    drift[2, 2] += slipping
    drift[3, 3] += slipping
    return np.asarray(drift)


@compiled
def _is_lost(seen: Array, last: Array, predicted: Array) -> bool:
    """A lost track shows the previous observation again, or no velocity at all where the puck should be moving."""
    repeated = True
    for i in range(5):
        repeated = repeated and seen[i] == last[i]
    moving = predicted[2] * predicted[2] + predicted[3] * predicted[3] > STILL * STILL
    return repeated or (moving and seen[2] == 0.0 and seen[3] == 0.0 and seen[4] == 0.0)


@compiled
def predict(state: Array, covariance: Array, duration: float, drift: Array, model: MotionModel) -> tuple[Array, Array]:
    """Carry mean and covariance over a duration; a bounce adds what is uncertain about it. Shapes (5,), (5, 5)."""
    e_spread, k_spread = model.e_spread, model.k_spread
    after, jacobian, bounces = transition(state, duration, model.constants)
    spread = drift.copy()
    add_congruence(spread, jacobian, covariance)
    if bounces > 0:
        spread[0, 0] += 0.002**2
        spread[1, 1] += 0.002**2
        for i in range(2, 4):
            spread[i, i] += (e_spread * state[i]) ** 2 + (k_spread * state[i]) ** 2 + 0.02**2
        spread[4, 4] += (2.0 * k_spread * (abs(state[2]) + abs(state[3])) / model.constants[7]) ** 2 + 1.0
    return after, spread


@compiled
def correct(state: Array, covariance: Array, seen: Array, model: FilterModel) -> tuple[Array, Array]:
    """The Kalman update; an observation that surprises first widens the prediction. Shapes (5,), (5, 5)."""
    innovation, root = seen - state, covariance + model.observation
    factor(root)
    if _distance(root, innovation) > model.surprise:
        covariance = covariance + model.contact
        covariance[0, 0] += innovation[0] ** 2
        covariance[1, 1] += innovation[1] ** 2
        root = covariance + model.observation
        factor(root)
    after, gain, keep = state.copy(), covariance.copy(), np.eye(5)
    for i in range(5):  # the gain P S⁻¹, row by row; both are symmetric
        solve_forward(root, gain[i])
        solve_backward(root, gain[i])
        for j in range(5):
            after[i] += gain[i, j] * innovation[j]
            keep[i, j] -= gain[i, j]
    spread = np.zeros((5, 5))  # Joseph's form: symmetric and positive whatever the rounding
    add_congruence(spread, keep, covariance)
    add_congruence(spread, gain, model.observation)
    return after, spread


@compiled
def _distance(root: Array, innovation: Array) -> float:
    """Squared Mahalanobis distance of an innovation, from Cholesky's factor of its covariance."""
    scaled, total = innovation.copy(), 0.0
    solve_forward(root, scaled)
    for i in range(5):
        total += scaled[i] * scaled[i]
    return total
