"""An agent wherever it lives: here, in a process, in a sandbox or behind a TCP port, it is called in one way."""

import abc
import contextlib
import time
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
CLOCKS: Final[dict[str, Callable[[], float]]] = {"wall": time.perf_counter, "cpu": time.thread_time}


class AgentHandle(abc.ABC):
    """What the evaluator may ask of an agent.

    Attributes:
        interpolation_order: That the agent's actions are meant for.
    """

    interpolation_order: int | None = 3

    @property
    def phase(self) -> str:
        """What the agent is doing, for logs and pictures; "" where it does not say."""
        return ""

    @property
    def target(self) -> Any:
        """Where it wants its mallet, seen from its own side, in [m]; None where it does not say."""
        return None

    @property
    def preprocessors(self) -> Sequence[Callable[[Array], Array]]:
        """Functions to apply to an observation before `act`, outside its clock."""
        return ()

    @property
    def isolation(self) -> str:
        """How far it is kept apart, and what limits it, as a record says it."""
        return "none"

    @property
    def printed(self) -> str:
        """The end of what it wrote to its standard output and error, where that is kept."""
        return ""

    def seed(self, sequence: np.random.SeedSequence) -> None:  # noqa: B027 - one here draws from the evaluator's
        """Seed the generators that it has to itself, when the next episode begins."""

    @abc.abstractmethod
    def episode_start(self) -> None:
        """A serve begins."""

    @abc.abstractmethod
    def act(self, observation: Array) -> Any:
        """The next command, in any shape that the agent likes. Shape of the observation (d,)."""

    @abc.abstractmethod
    def clock(self, kind: str) -> Callable[[], float]:
        """What measures the time of `act`, in [s].

        Args:
            kind: "wall" or "cpu".
        """

    def thinks_for(self, seconds: float) -> float:
        """Wait so long; gives the CPU time that it used meanwhile, in [s]; 0 where that cannot be told from the evaluator's."""
        return 0.0

    @abc.abstractmethod
    def stop(self) -> None:
        """Tell it that it is over, and close."""

    @abc.abstractmethod
    def close(self) -> None:
        """End its process, or hang up, without a word. May be called twice."""


class LocalAgent(AgentHandle):
    """An agent in this process.

    Args:
        agent: Has `episode_start`, `draw_action` and perhaps `preprocessors`, `stop`, `phase` and `target`.
        home: Working directory of a submission while its code runs; None for that of the evaluator.
    """

    def __init__(self, agent: Any, home: str | None = None) -> None:
        self.agent = agent
        self._home = home
        self.interpolation_order = getattr(agent, "interpolation_order", 3)

    @property
    def phase(self) -> str:
        """What the agent is doing."""
        return str(getattr(self.agent, "phase", ""))

    @property
    def target(self) -> Any:
        """Where it wants its mallet."""
        return getattr(self.agent, "target", None)

    @property
    def preprocessors(self) -> Sequence[Callable[[Array], Array]]:
        """The agent's own; they may change from serve to serve."""
        return tuple(getattr(self.agent, "preprocessors", ()))

    def episode_start(self) -> None:
        """A serve begins."""
        with self._at_home():
            self.agent.episode_start()

    def act(self, observation: Array) -> Any:
        """The next command."""
        if self._home is None:
            return self.agent.draw_action(observation)
        with self._at_home():
            return self.agent.draw_action(observation)

    def _at_home(self) -> contextlib.AbstractContextManager[None]:
        return contextlib.nullcontext() if self._home is None else contextlib.chdir(self._home)

    def clock(self, kind: str) -> Callable[[], float]:
        """The wall clock, or the CPU time of this thread."""
        return CLOCKS[kind]

    def stop(self) -> None:
        """Tell the agent, if it wants to know."""
        stop = getattr(self.agent, "stop", None)
        if stop is not None:
            stop()

    def close(self) -> None:
        """There is nothing to end."""
