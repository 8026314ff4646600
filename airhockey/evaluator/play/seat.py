"""A seat: one agent under care. It is built, seeded, told of serves and asked for commands; what it does wrong stays with it."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.packaging.unfetched import FETCH, missing_from
from airhockey.envs.copying import NotCopyable
from airhockey.evaluator.isolation.failures import agent_failures, describe
from airhockey.evaluator.isolation.handle import AgentHandle
from airhockey.evaluator.play.blame import fault_of_machine
from airhockey.evaluator.play.watchdog import Watch
from airhockey.evaluator.runs.game_records import HOME, Side
from airhockey.evaluator.runs.records import AgentProcess

Array = NDArray[np.float64]


def failed_after(failure: BaseException, step: int) -> str:
    """Why an agent failed, by the number of control steps before; `step` is the one that it failed in, from 1."""
    return f"step {max(step - 1, 0)}: {describe(failure)}"


@dataclass(frozen=True)
class Care:
    """How the agents of an episode or a game are taken care of.

    Attributes:
        clock: What the time of an action is measured with, "wall" or "cpu".
        time_limit: Longest time for an action, in [s], before the previous position is held.
        reason: From a failure and the control step that it happened in (0 in `episode_start`) to one line.
        watch: Ends a call that never returns, and tells whose code is running.
    """

    clock: str = "wall"
    time_limit: float = np.inf
    reason: Callable[[BaseException, int], str] = failed_after
    watch: Watch = field(default_factory=Watch)


class Seat(NotCopyable):
    """An agent under care.

    Args:
        agent: None where it could not be built.
        form: The format of its actions in the environment.
        care: How it is taken care of.
        side: Which robot it plays.
        name: Of the agent, or the path of its entry, which git may have left unfinished.

    Attributes:
        clock: What measures its actions, in [s].
        failure, error: Why it failed, as one line and as the exception; None while it did not.
        action: Its latest command, in the shape of `form`; zeros before the first.
        seconds: The time that it took.
        late: Whether that was too long, and the command is its previous position with zero velocity.
        isolation: How far the agent is kept apart, see `AgentHandle`.
        build_time, start_time: Wall time to build it, and of its longest start since the first of this episode, in [s].
        position: The joints that it had at the latest serve, in [rad], to be held if its first command is late. Shape (n,).
    """

    def __init__(self, agent: AgentHandle | None, form: Any, care: Care, side: Side = HOME, name: str = "") -> None:
        self.agent, self.form, self.side, self._name = agent, form, side, name
        self.failure: str | None = None
        self.error: BaseException | None = None
        self.clock = agent.clock(care.clock) if agent is not None else time.perf_counter
        self.action = np.zeros(form.shape)
        self.seconds, self.late = 0.0, False
        self.isolation = "" if agent is None else agent.isolation
        self.build_time = self.start_time = 0.0
        self.position: Array | None = None
        self._care, self._watch, self._time_limit = care, care.watch, care.time_limit
        self._timely: Array | None = None

    @property
    def phase(self) -> str:
        """What the agent is doing, for pictures."""
        return "" if self.agent is None else self.agent.phase

    @property
    def process(self) -> AgentProcess:
        """Where the agent lived, and what it took besides its commands, as records say it."""
        return AgentProcess(isolation=self.isolation, build_time=self.build_time, start_time=self.start_time)

    @property
    def target(self) -> Any:
        """Where it wants its mallet; see `AgentHandle`."""
        return None if self.agent is None else self.agent.target

    def seed(self, sequence: np.random.SeedSequence) -> None:
        """Seed the generators that the agent has to itself, when it is started."""
        self.start_time = 0.0
        if self.agent is not None:
            self.agent.seed(sequence)

    def start(self) -> None:
        """A serve begins; an agent that failed before does not hear of it. Raises `EnvironmentFault`, as `act` does."""
        if self.agent is None or self.failure is not None:
            return
        began = time.perf_counter()
        try:
            with self._watch.over(self.side):
                self.agent.episode_start()
                self._preprocessors = tuple(self.agent.preprocessors)
            self._act, self._timely = self.agent.act, None
        except agent_failures() as failure:
            self._fail(failure, 0)
        finally:
            self.start_time = max(self.start_time, time.perf_counter() - began)

    def act(self, observation: Array, step: int) -> None:
        """Ask for the command of a control step, from 1; it is then in `action`, or the seat has failed.

        Raises:
            EnvironmentFault: The machine failed, and not the agent.
        """
        if self.failure is not None:
            return
        try:
            clock, watch = self.clock, self._watch
            watch.enter(self.side)
            try:
                for preprocessor in self._preprocessors:
                    observation = preprocessor(observation)
                begin = clock()
                action = self._act(observation)
                self.seconds = clock() - begin
            finally:
                watch.leave()
            action = self.form.check(action, step)
        except agent_failures() as failure:
            self.late = False
            self._fail(failure, step)
            return
        self.late = self.seconds > self._time_limit
        if self.late:
            action = self._held_command()
        else:
            self._timely = action
        self.action = action

    def fail_to_build(self, failure: BaseException) -> None:
        """It could not be built, or not as it wants to be."""
        self.close()
        self.agent = None
        self.error, self.failure = failure, f"build_agent: {describe(failure)}{self._unfetched()}"

    def fail(self, failure: BaseException, step: int) -> None:
        """It failed in a control step, from 1; 0 in `episode_start`."""
        self.error, self.failure = failure, self._care.reason(failure, step) + self._unfetched()

    def _unfetched(self) -> str:
        """What git has not fetched of its checkout, behind a failure that may come from that."""
        what = missing_from(self._name)
        return f"; {what} ({FETCH})" if what else ""

    def _fail(self, failure: BaseException, step: int) -> None:
        """Its code raised: it failed, or the machine did under one of our own players."""
        fault = None if self.agent is None else fault_of_machine(failure, self.agent)
        if fault is not None:
            raise fault from failure
        self.fail(failure, step)

    def stop(self) -> None:
        """Tell the agent that it is over; one that has failed is ended without a word."""
        if self.agent is None or self.failure is not None:
            self.close()
            return
        try:
            with self._watch.over(self.side):
                self.agent.stop()
        except agent_failures() as failure:
            self.error = failure  # what it was asked for is played: that it fails now costs nothing

    def close(self) -> None:
        """End the agent without a word."""
        if self.agent is not None:
            self.agent.close()

    def _held_command(self) -> Array:
        """The latest timely position with zero velocity."""
        form, timely = self.form, self._timely
        held = np.zeros(form.shape)
        if timely is None:
            position = self.position
        elif form.order is None:
            position = timely[-1, 0]
        else:
            position = timely if timely.ndim == 1 else timely[0]
        if form.order is None:
            held[:, 0] = position
        elif held.ndim == 1:
            held[:] = position
        else:
            held[0] = position
        return held
