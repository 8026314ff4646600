"""Where the opponent's mallet will be: on its swing if it keeps one, else about where it is."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.base import task_of
from airhockey.agents.compiling import compiled
from airhockey.agents.small_matrices import factor, solve_backward, solve_forward

Array = NDArray[np.float64]

WINDOW = 128
"""Observations looked back at."""
LEAST = 40
"""Observations without which no swing is believed that was not expected."""
RATE = 3.0
"""Angular rate of the opponent in `7dof-hit` (challenge's section 4), in [rad]/[s]. Others must fit better by far."""
RATES = np.arange(1.0, 8.01, 0.25)
BETTER = 0.6
"""Share of the present rate's residual that another rate must stay below."""
BELIEVED = 0.012
"""Root mean square residual up to which a swing is believed, in [m]."""
NOISE = 0.005
"""Standard deviation of an observation, in [m]."""
SPREAD = np.array([[1.0, 1.0], [0.003, 0.3], [0.003, 0.3], [0.1, 0.003], [0.1, 0.003]])
"""Of the coefficients before anything is seen, in [m]: sideways a swing has the rate ω, lengthwise 2ω."""
EXPECTED_SPREAD = 0.02
"""Of the coefficients about those of an expected swing, in [m]."""


class OpponentTrack:
    """Fits  p(t) = c + a₁ cos ωt + b₁ sin ωt + a₂ cos 2ωt + b₂ sin 2ωt  to what was seen: least squares with a prior.

    In `7dof-hit` and `hit` the figure of eight is known, and so is its phase at the serve; it is what the prior expects there.
    Besides the best rate ω so far, one other is tried per observation.

    Attributes:
        swinging: Whether the fit is good enough to be believed.
    """

    def __init__(self, env_info: Mapping[str, Any]) -> None:
        """Compile."""
        self._dt = float(env_info["dt"])
        self._known = task_of(env_info) == "hit" and env_info["n_agents"] == 2
        self.reset()
        for step in range(LEAST + 1):
            self.update(np.array([0.86, 0.0]), step)
        self.swinging = True
        self.predict(np.arange(3.0))
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self._seen = np.zeros((WINDOW, 2))  # the newest last
        self._count = 0
        self._rate = RATE
        self._expected = self._known
        self._coefficients = np.zeros((5, 2))
        self.swinging = False

    def update(self, position: Array, step: int) -> None:
        """Take an observation of the mallet.

        Args:
            position: In the table frame, in [m]. Shape (2,).
            step: Control steps since the serve.
        """
        self._seen[:-1] = self._seen[1:]
        self._seen[-1] = position[:2]
        self._count += 1
        count = min(self._count, WINDOW)
        if count < LEAST and not self._expected:
            return
        mean, spread = np.zeros((5, 2)), SPREAD
        mean[0] = _mean(self._seen[-count:])
        if self._expected:
            mean, spread = figure_of_eight(RATE * self._dt * step), np.full((5, 2), EXPECTED_SPREAD)
        fit = _fit(self._seen[-count:], self._rate * self._dt, mean, spread)
        if fit[1] > (BELIEVED if self._expected else NOISE):
            other = float(RATES[self._count % len(RATES)])
            mean[1:] = 0.0
            trial = _fit(self._seen[-count:], other * self._dt, mean, SPREAD)
            if count >= LEAST and trial[1] < BETTER * fit[1]:
                self._rate, fit, self._expected = other, trial, False
        self._coefficients, residual = fit
        self.swinging = residual < BELIEVED

    def predict(self, times: Array) -> Array:
        """Positions at times from now, in [s]. Shape (k,) → (k, 2)."""
        if not self.swinging:
            last = self._seen[-1] if self._count else np.full(2, 10.0)  # nowhere near
            return np.full((len(times), 2), last)
        return _swing(self._rate * times, self._coefficients)


def figure_of_eight(turned: float) -> Array:
    """Coefficients of the opponent's swing in `7dof-hit`, in the table frame.

    At the phase φ = π/2 + `turned` it is at (0.86 − 0.1 sin φ cos φ, −0.16 cos φ) = (0.86 + 0.05 sin 2·turned, 0.16 sin turned).
    The coefficients have their time zero now. Shape (5, 2).
    """
    s, c = np.sin(turned), np.cos(turned)
    s2, c2 = np.sin(2.0 * turned), np.cos(2.0 * turned)
    return np.array([[0.86, 0.0], [0.0, 0.16 * s], [0.0, 0.16 * c], [0.05 * s2, 0.0], [0.05 * c2, 0.0]])


@compiled
def _fit(seen: Array, turn: float, mean: Array, spread: Array) -> tuple[Array, float]:
    """Coefficients (5, 2) with time 0 at the last observation, and the root mean square residual in [m].

    Args:
        seen: Shape (k, 2).
        turn: Phase per observation, in [rad].
        mean, spread: Prior of the coefficients. Shapes (5, 2).
    """
    k = len(seen)
    basis = _basis(turn * np.arange(1.0 - k, 1.0))
    normal, coefficients = np.zeros((5, 5)), np.zeros((2, 5))
    for i in range(k):
        for a in range(5):
            for b in range(a + 1):
                normal[a, b] += basis[i, a] * basis[i, b]
            for axis in range(2):
                coefficients[axis, a] += basis[i, a] * seen[i, axis]
    for axis in range(2):
        root = normal.copy()
        for a in range(5):
            weight = (NOISE / spread[a, axis]) ** 2
            root[a, a] += weight
            coefficients[axis, a] += weight * mean[a, axis]
        factor(root)
        solve_forward(root, coefficients[axis])
        solve_backward(root, coefficients[axis])
    total = 0.0
    for i in range(k):
        for axis in range(2):
            error = seen[i, axis]
            for a in range(5):
                error -= basis[i, a] * coefficients[axis, a]
            total += error * error
    return coefficients.T.copy(), np.sqrt(total / k)


@compiled
def _swing(phases: Array, coefficients: Array) -> Array:
    basis, places = _basis(phases), np.zeros((len(phases), 2))
    for i in range(len(phases)):
        for a in range(5):
            for axis in range(2):
                places[i, axis] += basis[i, a] * coefficients[a, axis]
    return places


@compiled
def _basis(phases: Array) -> Array:
    """1, cos φ, sin φ, cos 2φ, sin 2φ. Shape (k, 5)."""
    basis = np.empty((len(phases), 5))
    for i in range(len(phases)):
        c, s = np.cos(phases[i]), np.sin(phases[i])
        basis[i, 0], basis[i, 1], basis[i, 2], basis[i, 3], basis[i, 4] = 1.0, c, s, 2.0 * c * c - 1.0, 2.0 * s * c
    return basis


@compiled
def _mean(seen: Array) -> Array:
    """Of all rows. Shape (k, 2) → (2,)."""
    mean = np.zeros(2)
    for i in range(len(seen)):
        mean[0] += seen[i, 0]
        mean[1] += seen[i, 1]
    return mean / len(seen)
