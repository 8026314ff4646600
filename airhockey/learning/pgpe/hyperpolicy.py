"""The Gaussian hyperpolicy ν_ρ with ρ = (μ, log σ), its scores and its Fisher information (thesis 2.2.3).

    log ν(θ) = −½ Σᵢ [ (θᵢ − μᵢ)²/σᵢ² + 2 log σᵢ + log 2π ]
    ∇_μᵢ log ν = (θᵢ − μᵢ)/σᵢ²          ∇_σᵢ log ν = ((θᵢ − μᵢ)² − σᵢ²)/σᵢ³
    ∇_log σᵢ log ν = σᵢ ∇_σᵢ log ν = (θᵢ − μᵢ)²/σᵢ² − 1
    F = diag(1/σᵢ², 2)                   in (μᵢ, log σᵢ): (2.12)

The text prints the second formula with σᵢ in place of σᵢ² in the numerator; the derivative has the square.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Hyperpolicy:
    """Independent Gaussians over the parameters θ.

    Attributes:
        mean: μ. Shape (d,).
        log_sigma: log σ. Shape (d,).
    """

    mean: Array
    log_sigma: Array

    @property
    def sigma(self) -> Array:
        """σ. Shape (d,)."""
        return np.exp(self.log_sigma)

    def sample(self, random: np.random.Generator, count: int, symmetric: bool = False) -> Array:
        """Draw parameters.

        Args:
            random: Generator.
            count: How many, N.
            symmetric: In pairs on either side of μ (Sehnke et al. 2010), which takes the noise of the baseline out of
                the update of μ; the last one of an odd number stands alone.

        Returns:
            Shape (N, d).
        """
        d = self.mean.size
        if symmetric:
            half = random.standard_normal(((count + 1) // 2, d))
            noise = np.stack((half, -half), axis=1).reshape(-1, d)[:count]
        else:
            noise = random.standard_normal((count, d))
        return self.mean + self.sigma * noise

    def log_density(self, theta: Array) -> float:
        """log ν(θ) for one θ. Shape (d,)."""
        z = (theta - self.mean) / self.sigma
        return float(-0.5 * (z @ z + 2.0 * self.log_sigma.sum() + z.size * np.log(2.0 * np.pi)))

    def scores(self, theta: Array) -> tuple[Array, Array]:
        """∇_μ log ν and ∇_log σ log ν. θ of shape (N, d); both results too."""
        z = (theta - self.mean) / self.sigma
        return z / self.sigma, z**2 - 1.0

    def fisher(self) -> tuple[Array, Array]:
        """The diagonal of F in μ and in log σ. Shapes (d,), (d,)."""
        return self.sigma**-2, np.full_like(self.mean, 2.0)
