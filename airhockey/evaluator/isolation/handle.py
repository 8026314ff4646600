"""What the evaluator needs of agents that live elsewhere, beyond an agent's interface."""

import abc
from collections.abc import Callable

import numpy as np


class AgentHandle(abc.ABC):
    """An agent in another process or on another machine."""

    def seed(self, sequence: np.random.SeedSequence) -> None:  # noqa: B027 - one far away keeps its own
        """Seed the generators that it draws from, when the next episode begins."""

    @abc.abstractmethod
    def clock(self, kind: str) -> Callable[[], float]:
        """What measures the time of its answers, in [s].

        Args:
            kind: "wall" or "cpu".
        """

    @abc.abstractmethod
    def close(self) -> None:
        """End it, or hang up, without a word. May be called twice."""
