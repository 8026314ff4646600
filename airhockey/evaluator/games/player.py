"""The function that engines run for games: it builds the players and the environment, and plays."""

import copy
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np

from airhockey.envs.disturbances import Disturbances
from airhockey.evaluator.episode import agent_failures, describe
from airhockey.evaluator.games.film import Film, Rows
from airhockey.evaluator.games.judging import PenaltyCount, game_class
from airhockey.evaluator.games.play import GamePlay, Status
from airhockey.evaluator.games.records import Event, GameJob, GameOptions, GameRecord, PlayerResult
from airhockey.evaluator.player import as_order
from airhockey.evaluator.records import Order, StepTime
from airhockey.evaluator.seeding import seed_global_generators

DEFAULT_ORDER = 3


class Game(msgspec.Struct, frozen=True):
    """A played game: what the journal gets and what the film file gets."""

    record: GameRecord
    film: Rows


@dataclass
class GamePlayer:
    """Plays games; each with players built for it alone, so that no game depends on another.

    Attributes:
        options: How games are played.
        profile: The disturbances, which `options` name.
        on_step: For a live line, where games are played in this process.
        every: Control steps between two calls of it.
    """

    options: GameOptions
    profile: Disturbances
    on_step: Callable[[Status], None] | None = None
    every: int = 250

    def __call__(self, job: GameJob) -> Game:
        """Play one game from its job alone."""
        orders = self._order(job.home_order), self._order(job.away_order)
        env, agents, failures = self._build(job, orders)
        wanted = tuple(
            getattr(agent, "interpolation_order", order) if asked == "agent" else order
            for agent, order, asked in zip(agents, orders, (job.home_order, job.away_order), strict=True)
        )
        if wanted != orders and not any(failures):
            try:
                env, agents, failures = self._build(job, wanted)
            except agent_failures() as failure:  # an order that there is not
                failures = describe(failure), describe(failure)
        film = Film(self.options.steps, env.base_observation.size)
        play = GamePlay(job, self.options, env, agents, failures, film, self.on_step, self.every)
        record = play.play()
        for agent in agents:
            _stop(agent)
        return Game(record, film.rows)

    def _build(self, job: GameJob, orders: Any) -> tuple[Any, tuple[Any, Any], tuple[str | None, str | None]]:
        from airhockey import envs

        env = envs.make("tournament", orders, disturbances=self.profile, edition=self.options.edition)
        seed_global_generators(np.random.SeedSequence(job.seed, spawn_key=(2,)))
        home = _build_agent(job.home_agent, env.env_info, 1, orders[0], job.home_order)
        away = _build_agent(job.away_agent, env.env_info, 2, orders[1], job.away_order)
        return env, (home[0], away[0]), (home[1], away[1])

    @staticmethod
    def _order(asked: Order) -> int | None:
        return DEFAULT_ORDER if asked == "agent" else as_order(asked)


def lost(job: GameJob, options: GameOptions, reason: str) -> Game:
    """A game whose worker died every time: nobody can say whose fault it was, so both players fail it."""
    from airhockey.envs.editions import edition

    rules = edition(options.edition)
    result = PlayerResult(
        goals=0,
        points_by_faults=0,
        faults=0,
        penalty=0.0,
        deployability=game_class(rules, 0.0, 1),
        violations=PenaltyCount(rules).violations,
        held=0,
        computation_time=StepTime(),
        failure=reason,
    )
    event = Event(step=0, what="forfeit", why=reason)
    record = GameRecord(job=job, steps=0, home=result, away=result, winner="draw", events=(event,))
    return Game(record, np.empty((0, 0), dtype=np.float32))


def _build_agent(
    name: str, env_info: dict[str, Any], agent_id: int, order: int | None, asked: Order
) -> tuple[Any, str | None]:
    """An agent with its own copy of `env_info`, or the reason why there is none."""
    from airhockey.agents import AGENTS, build_agent

    kwargs = {"interpolation_order": order} if asked != "agent" and name in AGENTS else {}
    try:
        return build_agent(name, copy.deepcopy(env_info), agent_id=agent_id, **kwargs), None
    except agent_failures() as failure:
        return None, f"build_agent: {describe(failure)}"


def _stop(agent: Any) -> None:
    stop = getattr(agent, "stop", None)
    if stop is not None:
        try:
            stop()
        except agent_failures():
            return  # its game is played
