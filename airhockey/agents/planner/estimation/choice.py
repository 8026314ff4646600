"""Which kind of shot to play next, from what has become of those before: Thompson's sampling, anew in every game.

Every arm has a Beta belief about its points per try; each time the arm is played whose draw is highest. The draws come from
one generator with a fixed seed, so that a game depends on nothing but itself.
"""

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

    def draw(self) -> str:
        """The arm to play next."""
        return max(self.points, key=self._sample)

    def tell(self, arm: str, points: float) -> None:
        """What a try of an arm has brought: 1 for a goal, a third for a fault of the opponent's, 0 for nothing."""
        self.points[arm] += points
        self.tries[arm] += 1

    def _sample(self, arm: str) -> float:
        won = self._expected[arm] * self._weight + self.points[arm]
        lost = (1.0 - self._expected[arm]) * self._weight + self.tries[arm] - self.points[arm]
        return float(self._rng.beta(won, max(lost, 0.1)))
