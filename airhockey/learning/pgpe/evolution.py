"""CMA-ES (Hansen, package `cma`) behind the same interface as PGPE: a modern reference."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.errors import MissingDependencyError

Array = NDArray[np.float64]


class CmaSearch:
    """CMA-ES in coordinates whose unit is the σ that each parameter starts with."""

    def __init__(self, mean: Array, sigma: Array, lower: Array, upper: Array, count: int) -> None:
        """Begin a search.

        Args:
            mean, sigma: Of the distribution to start with. Shapes (d,), (d,).
            lower, upper: Bounds. Shapes (d,), (d,).
            count: Parameters tried in each iteration, at least 2.

        Raises:
            MissingDependencyError: There is no package `cma`.
        """
        try:
            import cma
        except ImportError as error:
            raise MissingDependencyError(
                "--optimizer cma needs the package cma; install it with: pip install 'airhockey[learn]'"
            ) from error
        self._unit, self._lower, self._upper = sigma, lower, upper
        self._random: np.random.Generator | None = None
        options = {
            "popsize": count,
            "randn": self._standard_normal,  # ours, so that a search depends on its seed alone
            "seed": np.nan,
            "verbose": -9,
            "bounds": [(lower / sigma).tolist(), (upper / sigma).tolist()],
            "CMA_diagonal": False,
        }
        self._search: Any = cma.CMAEvolutionStrategy((np.clip(mean, lower, upper) / sigma).tolist(), 1.0, options)
        self._asked: list[Array] = []

    @property
    def mean(self) -> Array:
        """Mean of the distribution. Shape (d,)."""
        return np.clip(np.asarray(self._search.result.xfavorite) * self._unit, self._lower, self._upper)

    @property
    def sigma(self) -> Array:
        """Standard deviation of each parameter. Shape (d,)."""
        return np.asarray(self._search.result.stds) * self._unit

    def ask(self, random: np.random.Generator, count: int) -> Array:
        """See `Search.ask`."""
        self._random = random
        self._asked = self._search.ask(count)
        return np.array(self._asked) * self._unit

    def tell(self, theta: Array, values: Array, rate: float) -> None:
        """See `Search.tell`; there is no learning rate here."""
        self._search.tell(self._asked, (-values).tolist())

    def _standard_normal(self, *shape: int) -> Array:
        if self._random is None:
            return np.zeros(shape)
        return self._random.standard_normal(shape)
