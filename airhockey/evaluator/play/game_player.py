"""The function that engines run for games: it builds the players and the environment, and plays."""

import contextlib
import copy
import gc
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from airhockey.envs.actions import ORDERS
from airhockey.envs.disturbances import Disturbances
from airhockey.evaluator.judging.games import PenaltyCount, game_class, winner
from airhockey.evaluator.play.episode import agent_failures, describe
from airhockey.evaluator.play.episode_player import as_order, named_order
from airhockey.evaluator.play.game import GamePlay, OnStep
from airhockey.evaluator.play.seeding import seed_global_generators
from airhockey.evaluator.play.watchdog import Watch
from airhockey.evaluator.runs.game_records import (
    AWAY,
    HOME,
    SIDES,
    Event,
    GameJob,
    GameOptions,
    GameRecord,
    PlayerResult,
    Side,
    file_name,
)
from airhockey.evaluator.runs.game_trajectories import Film, Rows
from airhockey.evaluator.runs.records import Order, StepTime

Build = tuple[Any, str | None]
"""An agent, or None and the reason."""


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
        live: Folder where games in progress are shown, if this process sees it; None for nowhere.
        on_step: Called now and then, where games are played in this process.
        every: Control steps between two reports.
    """

    options: GameOptions
    profile: Disturbances
    live: Path | None = None
    on_step: OnStep | None = None
    every: int = 250

    def __call__(self, job: GameJob) -> Game:
        """Play one game from its job alone."""
        with Watch(None if self.live is None else live_file(self.live, job)) as watch:
            env, builds = self._build(job, watch)
            agents, failures = zip(*builds, strict=True)
            gc.collect()
            gc.freeze()  # or a collection in the middle of a game would walk over every module ever imported
            film = Film(self.options.steps, env.base_observation.size)
            play = GamePlay(job, self.options, env, agents, failures, film, watch, self.on_step, self.every)
            record = play.play()
            _stop(agents, watch)
            gc.unfreeze()
        return Game(record, film.rows)

    def _build(self, job: GameJob, watch: Watch) -> tuple[Any, tuple[Build, Build]]:
        """The environment in the orders that were asked for, or that the agents want, and the agents."""
        asked = job.home_order, job.away_order
        orders = self._order(job.home_order, job.home_agent), self._order(job.away_order, job.away_agent)
        env, builds = self._build_with(job, orders, watch)
        home, away = (
            getattr(agent, "interpolation_order", order) if asks == "agent" and failure is None else order
            for (agent, failure), order, asks in zip(builds, orders, asked, strict=True)
        )
        if (home, away) == orders:
            return env, builds
        _stop((builds[0][0], builds[1][0]), watch)
        bad = tuple(
            None if order in ORDERS else f"build_agent: unknown interpolation order {order!r}" for order in (home, away)
        )
        if any(bad):
            return env, ((None, bad[0]) if bad[0] else builds[0], (None, bad[1]) if bad[1] else builds[1])
        return self._build_with(job, (home, away), watch)

    def _build_with(
        self, job: GameJob, orders: tuple[int | None, int | None], watch: Watch
    ) -> tuple[Any, tuple[Build, Build]]:
        from airhockey import envs

        env = envs.make("tournament", orders, disturbances=self.profile, edition=self.options.edition)
        seed_global_generators(np.random.SeedSequence(job.seed, spawn_key=(2,)))
        with watch.over(HOME):
            home = self._build_agent(job.home_agent, env, 1, orders[0], job)
        with watch.over(AWAY):
            away = self._build_agent(job.away_agent, env, 2, orders[1], job)
        return env, (home, away)

    def _build_agent(self, name: str, env: Any, agent_id: int, order: int | None, job: GameJob) -> Build:
        """An agent with its own copy of `env_info`, or the reason why there is none."""
        from airhockey.agents import AGENTS
        from airhockey.evaluator.isolation.build import build_agent
        from airhockey.evaluator.isolation.modes import choose

        asked = job.home_order if agent_id == 1 else job.away_order
        kwargs: dict[str, Any] = {"interpolation_order": order} if asked != "agent" and name in AGENTS else {}
        isolate = None if self.options.isolate == "auto" else self.options.isolate
        try:
            agent = build_agent(
                name,
                env,
                agent_id,
                mode=choose(name, isolate).mode,
                patience=self.options.patience,
                order=order,
                seed=np.random.SeedSequence(job.seed, spawn_key=(2, agent_id)),
                env_info=copy.deepcopy(env.env_info),
                **kwargs,
            )
        except agent_failures() as failure:
            return None, f"build_agent: {describe(failure)}"
        return agent, None

    @staticmethod
    def _order(asked: Order, agent: str) -> int | None:
        return named_order(agent) if asked == "agent" else as_order(asked)


def live_file(folder: Path, job: GameJob) -> Path:
    """Where a game in progress is shown."""
    return folder / file_name(job.key)


def lost(job: GameJob, options: GameOptions, reason: str, guilty: Side | None) -> Game:
    """A game whose worker died every time; it is forfeited by the player whose code ran then, or by both if nobody knows."""
    from airhockey.envs.editions import edition

    rules = edition(options.edition)

    def result(side: Side) -> PlayerResult:
        return PlayerResult(
            goals=0,
            points_by_faults=0,
            faults=0,
            penalty=0.0,
            deployability=game_class(rules, 0.0, 1),
            violations=PenaltyCount(rules).violations,
            held=0,
            computation_time=StepTime(),
            failure=reason if guilty in (side, None) else None,
        )

    home, away = result(HOME), result(AWAY)
    record = GameRecord(
        job=job,
        steps=0,
        home=home,
        away=away,
        winner=winner(rules, options.variant, options.steps, home, away),
        events=(Event(step=0, what="forfeit", who=guilty, why=reason),),
    )
    return Game(record, np.empty((0, 0), dtype=np.float32))


def _stop(agents: tuple[Any, Any], watch: Watch) -> None:
    """Tell the agents that it is over."""
    for side, agent in zip(SIDES, agents, strict=True):
        stop = getattr(agent, "stop", None)
        if stop is not None:
            with contextlib.suppress(*agent_failures()), watch.over(side):  # its game is played
                stop()
