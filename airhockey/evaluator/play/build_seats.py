"""Agents take their seats at an environment, in the interpolation orders that were asked for or that they want."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from airhockey.errors import AirHockeyError, ConfigurationError, EnvironmentFault
from airhockey.evaluator.isolation.failures import agent_failures, describe
from airhockey.evaluator.isolation.handle import AgentHandle
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.isolation.modes import Mode, choose
from airhockey.evaluator.play.blame import fault_of_machine
from airhockey.evaluator.play.seat import Care, Seat
from airhockey.evaluator.play.seeding import seed_global_generators
from airhockey.evaluator.runs.game_records import SIDES
from airhockey.evaluator.runs.records import Order

Orders = tuple[int | None, ...]


@dataclass(frozen=True)
class Entrant:
    """Who is to take a seat.

    Attributes:
        agent: A name of the registry, the path of a submission, or tcp://HOST:PORT.
        order: The interpolation order asked for.
        isolate: Where it is to live; "auto" is here for our own agents, elsewhere for submissions.
        limits: What it may use there, and how long anybody waits.
        parameters: Of the rule-based player.
        seed: Of the generators of a process of its own, while it is built.
        python: Another interpreter for its process.
        settings: Of our own players' controller.
    """

    agent: str
    order: Order = "agent"
    isolate: str = "none"
    limits: Limits = field(default_factory=Limits)
    parameters: str | None = None
    seed: np.random.SeedSequence | None = None
    python: str | None = None
    settings: tuple[str, ...] = ()

    @property
    def first_order(self) -> int | None:
        """The order asked for, or the one that a submission's files name; 3, the usual one, for everybody else."""
        from airhockey.agents.submission import is_submission, wanted_order

        if self.order != "agent":
            return self.order if isinstance(self.order, int) else None
        try:
            return wanted_order(Path(self.agent)) if is_submission(self.agent) else 3
        except ConfigurationError:
            return 3  # the builder will say the same

    @property
    def mode(self) -> Mode:
        """Where it is to live; raises `ConfigurationError` where this machine cannot have that."""
        return choose(self.agent, None if self.isolate == "auto" else self.isolate).mode

    def build(self, env: Any, agent_id: int, mode: Mode) -> AgentHandle:
        """The agent, made for this environment. Raises what its code raises."""
        from airhockey.agents import AGENTS
        from airhockey.evaluator.isolation.build import build_agent

        kwargs: dict[str, Any] = {}
        if self.order != "agent" and self.agent in AGENTS:
            # Our own agents can play any order; a submission's order is a matter of its agent_config.yml.
            kwargs["interpolation_order"] = env.formats[agent_id - 1].order
        if self.settings and self.agent in AGENTS:
            kwargs["settings"] = self.settings
        if self.parameters is not None:
            kwargs["parameters"] = self.parameters
        return build_agent(
            self.agent, env, agent_id, mode=mode, limits=self.limits, seed=self.seed, python=self.python, **kwargs
        )


def build_seats(
    make: Callable[[Orders], Any], entrants: Sequence[Entrant], care: Care, seed: np.random.SeedSequence | None = None
) -> tuple[Any, tuple[Seat, ...]]:
    """An environment, and everybody's seat at it; who could not be built has failed.

    Args:
        make: Makes the environment from the interpolation order of each player.
        entrants: Who plays.
        care: How they are taken care of.
        seed: Of the generators that agents in this process share, while they are built.

    Raises:
        EnvironmentFault: The environment could not be made, or this machine failed while an agent was built.
    """

    def build(orders: Orders) -> tuple[Any, tuple[Seat, ...]]:
        env = _made(make, orders)
        if seed is not None:
            seed_global_generators(seed)
        return env, tuple(_seat(entrant, env, k, care) for k, entrant in enumerate(entrants))

    orders = tuple(entrant.first_order for entrant in entrants)
    env, seats = build(orders)
    if any(seat.agent is None for seat in seats):
        return env, seats
    wanted = tuple(
        seat.agent.interpolation_order if entrant.order == "agent" and seat.agent is not None else order
        for seat, entrant, order in zip(seats, entrants, orders, strict=True)
    )
    if wanted == orders or not _all_there(seats, wanted):
        return env, seats
    for seat in seats:
        seat.stop()
    return build(wanted)


def _made(make: Callable[[Orders], Any], orders: Orders) -> Any:
    """The environment; what is not said by us, such as an error of the compiler, is a fault of the machine or installation."""
    try:
        return make(orders)
    except AirHockeyError:
        raise
    except Exception as error:
        raise EnvironmentFault(
            f"the environment cannot be made here, which is no agent's fault: {describe(error)}"
        ) from error


def _seat(entrant: Entrant, env: Any, k: int, care: Care) -> Seat:
    mode, began = entrant.mode, time.perf_counter()
    try:
        with care.watch.over(SIDES[k]):
            agent = entrant.build(env, k + 1, mode)
    except agent_failures() as failure:
        fault = fault_of_machine(failure, entrant.agent, mode)
        if fault is not None:
            raise fault from failure
        seat = Seat(None, env.formats[k], care, SIDES[k], entrant.agent)
        seat.fail_to_build(failure)
        seat.isolation = mode
    else:
        seat = Seat(agent, env.formats[k], care, SIDES[k], entrant.agent)
    seat.build_time = time.perf_counter() - began
    return seat


def _all_there(seats: Sequence[Seat], orders: Orders) -> bool:
    """Whether these are orders; a seat whose agent wants another one has failed."""
    from airhockey.envs.actions import ActionFormat

    for seat, order in zip(seats, orders, strict=True):
        try:
            ActionFormat(order, 1)
        except ConfigurationError as error:
            seat.fail_to_build(error)
    return all(seat.failure is None for seat in seats)
