"""PGPE: policy gradients with parameter-based exploration, with and without baseline and natural gradient (algorithms
2.1 and 2.2), behind the interface that every search here has.

    ∇_ρ J ≈ 1/N Σᵢ (Ĵ(θᵢ) − b) ∇_ρ log ν(θᵢ)
    plain:    ρ ← ρ + α ∇_ρ J                         ρ = (μ, log σ)
    natural:  ρ ← ρ + α F⁻¹ ∇_ρ J                     Δμᵢ = α σᵢ² ∇_μᵢ J,  Δlog σᵢ = α/2 ∇_log σᵢ J
    thesis:   Δμᵢ as one of these                     Δσᵢ = α 1/N Σ (Ĵ − b) ((θᵢ − μᵢ)² − σᵢ²)/σᵢ, of σ and not of its logarithm
"""

from dataclasses import dataclass
from typing import Literal, Protocol, get_args

import numpy as np
from numpy.typing import NDArray

from airhockey.learning.diverged import DivergedError
from airhockey.learning.pgpe.hyperpolicy import Hyperpolicy

Array = NDArray[np.float64]
Baseline = Literal["none", "mean", "moving", "optimal"]
BASELINES: tuple[str, ...] = get_args(Baseline)
_MEMORY = 0.8
"""Share of the moving baseline that an iteration keeps."""


class Search(Protocol):
    """Asks for the value of parameters and is told.

    Attributes:
        mean, sigma: Of the distribution that it samples from. Shapes (d,), (d,).
    """

    @property
    def mean(self) -> Array: ...  # noqa: D102 - see the class

    @property
    def sigma(self) -> Array: ...  # noqa: D102 - see the class

    def ask(self, random: np.random.Generator, count: int) -> Array:
        """Parameters to try. Shape (count, d)."""

    def tell(self, theta: Array, values: Array, rate: float) -> None:
        """Their values, the more the better, of shape (count,); and the learning rate, where there is one."""


@dataclass
class Pgpe:
    """The search of the thesis.

    Attributes:
        policy: The hyperpolicy.
        lower, upper: Bounds of μ. Shapes (d,), (d,).
        natural: Use the natural gradient.
        baseline: "none", the "mean" of the iteration, the "moving" average of the thesis, or the "optimal" one for
            each parameter that makes the estimate's variance least (as in MushroomRL).
        normalize: Divide J − b by its root mean square among the N, so that rewards of any size fit one learning
            rate.
        symmetric: Sample in pairs.
        sigma_share: Learning rate of log σ, as a share of that of μ.
        sigma_rule: What is updated, log σ ("log") or σ itself, by the thesis's rule ("thesis").
    """

    policy: Hyperpolicy
    lower: Array
    upper: Array
    natural: bool = True
    baseline: str = "optimal"
    normalize: bool = True
    symmetric: bool = False
    sigma_share: float = 1.0
    sigma_rule: str = "log"
    moving: float | None = None

    @property
    def mean(self) -> Array:
        """μ."""
        return self.policy.mean

    @property
    def sigma(self) -> Array:
        """σ."""
        return self.policy.sigma

    def ask(self, random: np.random.Generator, count: int) -> Array:
        """See `Search.ask`."""
        return self.policy.sample(random, count, self.symmetric)

    def tell(self, theta: Array, values: Array, rate: float) -> None:
        """See `Search.tell`."""
        for_mean, for_log_sigma = self.gradient(theta, values)
        plain = for_log_sigma
        if self.natural:
            fisher_mean, fisher_log_sigma = self.policy.fisher()
            for_mean, for_log_sigma = for_mean / fisher_mean, for_log_sigma / fisher_log_sigma
        mean = np.clip(self.policy.mean + rate * for_mean, self.lower, self.upper)
        if self.sigma_rule == "log":
            log_sigma = self.policy.log_sigma + rate * self.sigma_share * for_log_sigma
        else:
            log_sigma = self._log_sigma_of_the_thesis(rate * self.sigma_share, plain)
        self.policy = Hyperpolicy(mean, log_sigma)
        average = float(values.mean())
        self.moving = average if self.moving is None else _MEMORY * self.moving + (1.0 - _MEMORY) * average

    def _log_sigma_of_the_thesis(self, rate: float, for_log_sigma: Array) -> Array:
        """σ + α ∇: with (θ − μ)² − σ² = σ² (z² − 1) its step is α σ ∇_log σ J. A step that leaves no σ > 0 has none."""
        sigma = self.sigma * (1.0 + rate * for_log_sigma)
        if not (sigma > 0.0).all():
            raise DivergedError(
                f"the thesis's rule makes σ {sigma.min():.3g}: a smaller --learning-rate or --sigma-rule log may help"
            )
        return np.log(sigma)

    def gradient(self, theta: Array, values: Array) -> tuple[Array, Array]:
        """The estimate of ∇_μ J and ∇_log σ J.

        Args:
            theta: Shape (N, d).
            values: Ĵ(θᵢ). Shape (N,).

        Returns:
            Shapes (d,), (d,).
        """
        scale = self._scale(values)
        if scale == 0.0:  # all are as good as expected: nothing to learn
            return np.zeros_like(self.mean), np.zeros_like(self.mean)
        for_mean, for_log_sigma = (self._estimate(score, values) / scale for score in self.policy.scores(theta))
        return for_mean, for_log_sigma

    def _scale(self, values: Array) -> float:
        """Root mean square of J − b with one b for all: a baseline far off must not make for a long step."""
        if not self.normalize:
            return 1.0
        baseline = float(values.mean()) if self.baseline == "optimal" else self._scalar_baseline(values)
        return float(np.sqrt(np.mean((values - baseline) ** 2)))

    def _estimate(self, scores: Array, values: Array) -> Array:
        """1/N Σ (J − b) ∇log ν for one half of ρ. Shape (d,)."""
        result: Array = (scores * (values[:, None] - self._baseline(scores, values))).mean(axis=0)
        return result

    def _baseline(self, scores: Array, values: Array) -> Array | float:
        if self.baseline == "optimal":
            squares = scores**2
            total = squares.sum(axis=0)
            return np.where(total > 0.0, values @ squares / np.where(total > 0.0, total, 1.0), 0.0)
        return self._scalar_baseline(values)

    def _scalar_baseline(self, values: Array) -> float:
        if self.baseline == "mean" or (self.baseline == "moving" and self.moving is None):
            return float(values.mean())
        return float(self.moving or 0.0) if self.baseline == "moving" else 0.0


def check_progress(search: Search, sigma_at_start: Array, values: Array) -> None:
    """Stop a search that goes astray.

    Raises:
        DivergedError: A return is not finite, or a σ has collapsed or exploded; the message says which and what may help.
    """
    if not np.isfinite(values).all():
        raise DivergedError(f"returns that are not finite: {values[~np.isfinite(values)][:3]}")
    if not np.isfinite(search.mean).all():
        raise DivergedError("μ is not finite: a smaller --learning-rate may help")
    ratio = search.sigma / sigma_at_start
    if not np.isfinite(ratio).all() or ratio.max() > 100.0:
        raise DivergedError(
            f"σ exploded to {np.max(ratio):.3g} times its start: a smaller --learning-rate or more --candidates may help"
        )
    if ratio.min() < 1e-3:
        raise DivergedError(
            f"σ collapsed to {ratio.min():.3g} times its start: a smaller --learning-rate or more --candidates may help"
        )
