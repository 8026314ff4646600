"""Which kind of shot to play next, from what has become of those before: Thompson's sampling, anew in every game.

Every arm has a Beta belief about its points per try; each time the arm is played whose draw is highest. The draws come from
one generator with a fixed seed, so that a game depends on nothing but itself.
"""

from collections.abc import Collection

import numpy as np

SEED = 5


class Arms:
    """Beliefs about some arms.

    Attributes:
        points, tries: So far, of every arm.
    """

    def __init__(self, expected: dict[str, float], weight: float) -> None:
        """Begin with beliefs.

        Args:
            expected: Arm -> points per try to begin with, between 0 and 1.
            weight: How many tries these are worth.
        """
        self.points = dict.fromkeys(expected, 0.0)
        self.tries = dict.fromkeys(expected, 0)
        self._expected, self._weight = expected, weight
        self._rng = np.random.default_rng(SEED)

    def draw(self, without: Collection[str] = ()) -> str | None:
        """The arm to play next, but for those that cannot be played now; None where no other is left."""
        left = [arm for arm in self.points if arm not in without]
        return max(left, key=self._sample) if left else None

    def tell(self, arm: str, points: float) -> None:
        """What a try of an arm has brought: 1 for a goal, a third for a fault of the opponent's, 0 for nothing."""
        self.points[arm] += points
        self.tries[arm] += 1

    def _sample(self, arm: str) -> float:
        won = self._expected[arm] * self._weight + self.points[arm]
        lost = (1.0 - self._expected[arm]) * self._weight + self.tries[arm] - self.points[arm]
        return float(self._rng.beta(won, max(lost, 0.1)))
