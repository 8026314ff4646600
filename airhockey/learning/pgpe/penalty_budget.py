"""The constrained variant: a Lagrange multiplier holds the mean penalty below a budget.

    max_ρ E[J]  subject to  E[C] ≤ d        L(ρ, λ) = E[J] − λ (E[C] − d)
    λ ← max(0, λ + η (C̄ − d))               after each iteration (dual ascent)

C is the penalty of an episode in the challenge's points, without those for computation time: that depends on the machine.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass
class PenaltyBudget:
    """The multiplier of one constraint.

    Attributes:
        budget: d, in points per episode; None where there is none.
        rate: η.
        multiplier: λ, in standard deviations of the return per point.
    """

    budget: float | None
    rate: float
    multiplier: float = 0.0

    def values(self, returns: Array, penalties: Array) -> Array:
        """J − λ C of each θ, with J in units of its standard deviation, so that λ means the same for every reward.

        Args:
            returns: J. Shape (N,).
            penalties: C. Shape (N,).
        """
        if self.budget is None:
            return returns
        scale = float(returns.std()) or 1.0
        return returns / scale - self.multiplier * penalties

    def update(self, penalties: Array) -> None:
        """Dual ascent by the penalties of an iteration. Shape (N,)."""
        if self.budget is not None:
            self.multiplier = max(0.0, self.multiplier + self.rate * (float(penalties.mean()) - self.budget))
