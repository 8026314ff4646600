"""Watching the opponent: where its mallet will be, as far as it repeats itself.

The mallet's recent positions are fitted by a constant and the first two harmonics of a rate ω (least squares): the
practice opponent of 7dof-hit runs a figure of eight with ω = 3 rad/s. Where the fit is bad the mallet is taken to
stay where it is.
"""

from collections.abc import Iterator

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
        self._places = np.zeros((2 * window, 2))  # the last ones are the rows up to `_end`
        # The time is counted from the last position, so that the basis and its inverse depend on their number alone.
        self._bases = [self._basis(dt * np.arange(1.0 - count, 1.0)) for count in range(window + 1)]
        self._inverses = [np.linalg.pinv(basis) if len(basis) >= shortest else None for basis in self._bases]
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self._end = 0
        self._count = 0
        self._fit: Array | None = None
        self._stale = False

    def see(self, position: Array | None) -> None:
        """Take the opponent's position of this step, in [m], shape (2,); None where there is no opponent."""
        if position is not None:
            if self._end == len(self._places):
                self._end = self._window - 1
                self._places[: self._end] = self._places[1 - self._window :]
            self._places[self._end] = position
            self._end, self._count = self._end + 1, min(self._count + 1, self._window)
            self._stale = True

    @property
    def ready(self) -> bool:
        """Whether it has been watched for long enough to tell whether it repeats itself."""
        return self._count >= self._shortest

    @property
    def repeats(self) -> bool:
        """Whether it has not been watched for long enough, or does repeat itself."""
        return not self.ready or self._latest_fit() is not None

    def predict(self, ahead: float) -> Array | None:
        """Where the mallet will be after a time in [s]; None without an opponent. Shape (2,)."""
        return self.at(ahead) if self._count else None

    def at(self, ahead: float) -> Array:
        """The same where there is an opponent. Shape (2,)."""
        return next(self.along(np.array([ahead])))

    def along(self, times: Array) -> Iterator[Array]:
        """The same at several times, in [s]; each is worked out when it is asked for. Shape (k,) → k times (2,)."""
        fit = self._latest_fit()
        if fit is None:
            few = min(self._count, 5)
            place = self._places[self._end - few : self._end].sum(axis=0) / few
            yield from (place for _ in times)
            return
        for row in self._basis(times):
            yield row @ fit

    def _latest_fit(self) -> Array | None:
        if self._stale:  # most of the time nobody asks
            self._fit, self._stale = self._fitted(), False
        return self._fit

    def _basis(self, times: Array) -> Array:
        phase = self._rate * times
        basis = np.empty((len(times), 5))
        basis[:, 0] = 1.0
        basis[:, 1], basis[:, 2] = np.cos(phase), np.sin(phase)
        basis[:, 3], basis[:, 4] = np.cos(2 * phase), np.sin(2 * phase)
        return basis

    def _fitted(self) -> Array | None:
        inverse = self._inverses[self._count]
        if inverse is None:
            return None
        seen = self._places[self._end - self._count : self._end]
        solution: Array = inverse @ seen
        error = self._bases[self._count] @ solution - seen
        error *= error
        return solution if float((error[:, 0] + error[:, 1]).sum()) / self._count < self._tolerance**2 else None
