"""Watching the opponent: where its mallet will be, as far as it repeats itself.

The mallet's recent positions are fitted by a constant and the first two harmonics of a rate ω (least squares): the
practice opponent of 7dof-hit runs a figure of eight with ω = 3 rad/s. Where the fit is bad the mallet is taken to
stay where it is.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class OpponentWatch:
    """Keeps the last positions of the opponent's mallet."""

    def __init__(self, rate: float, dt: float, window: int = 100, shortest: int = 35, tolerance: float = 0.015) -> None:
        """Set up an empty memory.

        Args:
            rate: ω, in [rad]/[s].
            dt: Time between observations, in [s].
            window: How many positions are kept.
            shortest: How many are needed for a fit.
            tolerance: Largest root mean square error of a usable fit, in [m].
        """
        self._rate, self._dt = rate, dt
        self._window, self._shortest, self._tolerance = window, shortest, tolerance
        # The time is counted from the last position, so that the basis and its inverse depend on their number alone.
        self._bases = [self._basis(dt * np.arange(1.0 - count, 1.0)) for count in range(window + 1)]
        self._inverses = [np.linalg.pinv(basis) if len(basis) >= shortest else None for basis in self._bases]
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self._seen: list[Array] = []
        self._fit: Array | None = None
        self._stale = False

    def see(self, position: Array | None) -> None:
        """Take the opponent's position of this step, in [m], shape (2,); None where there is no opponent."""
        if position is not None:
            self._seen = [*self._seen[1 - self._window :], position]
            self._stale = True

    @property
    def ready(self) -> bool:
        """Whether it has been watched for long enough to tell whether it repeats itself."""
        return len(self._seen) >= self._shortest

    @property
    def repeats(self) -> bool:
        """Whether it has not been watched for long enough, or does repeat itself."""
        return not self.ready or self._latest_fit() is not None

    def predict(self, ahead: float) -> Array | None:
        """Where the mallet will be after a time in [s]; None without an opponent. Shape (2,)."""
        return self.at(ahead) if self._seen else None

    def at(self, ahead: float) -> Array:
        """The same where there is an opponent. Shape (2,)."""
        fit = self._latest_fit()
        if fit is None:
            return np.asarray(np.mean(self._seen[-5:], axis=0))
        return np.asarray(self._basis(np.array([ahead]))[0] @ fit)

    def _latest_fit(self) -> Array | None:
        if self._stale:  # most of the time nobody asks
            self._fit, self._stale = self._fitted(), False
        return self._fit

    def _basis(self, times: Array) -> Array:
        phase = self._rate * times
        return np.stack(
            [np.ones_like(phase), np.cos(phase), np.sin(phase), np.cos(2 * phase), np.sin(2 * phase)], axis=1
        )

    def _fitted(self) -> Array | None:
        inverse = self._inverses[len(self._seen)]
        if inverse is None:
            return None
        seen = np.array(self._seen)
        solution = inverse @ seen
        error = self._bases[len(seen)] @ solution - seen
        return np.asarray(solution) if float(np.mean(np.sum(error**2, axis=1))) < self._tolerance**2 else None
