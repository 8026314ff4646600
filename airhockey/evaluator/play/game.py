"""Games: the function that engines run. It seats two agents at a table for one game, plays it, and keeps it for the judge."""

import functools
import gc
import re
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from airhockey.envs.disturbances import Disturbances
from airhockey.envs.editions import edition
from airhockey.errors import ActionError, SimulationError
from airhockey.evaluator.isolation.failures import describe
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.judging.games import PenaltyCount, game_class, winner
from airhockey.evaluator.play.build_seats import Entrant, build_seats
from airhockey.evaluator.play.events import EventLog
from airhockey.evaluator.play.penalties import Penalties
from airhockey.evaluator.play.rollout import Rollout
from airhockey.evaluator.play.seat import Care, Seat
from airhockey.evaluator.play.seeding import game_agents_seed, seed_global_generators
from airhockey.evaluator.play.watchdog import Watch
from airhockey.evaluator.runs.game_records import (
    AWAY,
    HOME,
    Event,
    GameJob,
    GameOptions,
    GameRecord,
    PlayerResult,
    Side,
    Status,
    file_name,
)
from airhockey.evaluator.runs.game_trajectories import Film, Rows
from airhockey.evaluator.runs.records import StepTime

Array = NDArray[np.float64]
TIME_LIMIT = 0.02
"""Longest time for one action, in [s], before the previous position is held."""


class Game(msgspec.Struct, frozen=True):
    """A played game: what the journal gets and what the trajectory file gets."""

    record: GameRecord
    film: Rows


class GamePlay:
    """A game in progress.

    Args:
        job: Which game.
        options: How it is played.
        env: The tournament environment.
        seats: Home's and away's.

    Attributes:
        film: Keeps what is needed to show the game again; None for nothing.
    """

    def __init__(self, job: GameJob, options: GameOptions, env: Any, seats: tuple[Seat, ...]) -> None:
        self.job, self.options, self.env, self.seats = job, options, env, seats
        self.film: Film | None = None
        self._rules = edition(options.edition)
        self._episode = self._rules.horizon.task
        self._environment_seed = np.random.SeedSequence(job.seed).spawn(1)[0]
        self._agents_seed = game_agents_seed(options.agent_seed, job.seed, job.key)
        self.rollout = Rollout(env, seats, self._environment_seed, options.real_time)
        self.log = EventLog(env, self._rules.game.faults_per_point)
        self.penalties = [Penalties(seat, self._rules, env.constraint_slices) for seat in seats]

    @property
    def events(self) -> list[Event]:
        """What happened so far."""
        return self.log.events

    @property
    def over(self) -> bool:
        """Whether its last step is played, or a player has failed."""
        return self.rollout.steps >= self.options.steps or self.rollout.failed

    def play(self, on_step: Callable[["GamePlay"], None] | None = None) -> GameRecord:
        """Play to the last step, or to a forfeit.

        Args:
            on_step: Called after every control step.
        """
        self.begin()
        while not self.over:
            if self.step() and on_step is not None:
                on_step(self)
        return self.end()

    def begin(self) -> None:
        """Seed everything and serve."""
        seed_global_generators(self._agents_seed)
        for seat, seed in zip(self.seats, self._agents_seed.spawn(2), strict=True):
            seat.seed(seed)
        self._serve()

    def step(self) -> bool:
        """One control step, and a new serve where it ends one; False where a player failed."""
        rollout = self.rollout
        finished, step = rollout.step(), rollout.steps
        home, away = self.seats
        if home.late or away.late:
            self._note_late(step)
        if not finished:
            return False
        constraints = self.env.constraint_values
        self.penalties[0].see(constraints[0])
        self.penalties[1].see(constraints[1])
        if self.film is not None:
            self.film.add(self.env)
        if step % self._episode == 0:
            self._end_episode(step)
        if rollout.over:
            self.log.verdict(step)
            self._serve()
        return True

    def end(self) -> GameRecord:
        """The record of a game that is over."""
        step = self.rollout.steps
        self.log.forfeits(step, self.seats)
        self._end_episode(step)
        home, away = (self._result(k, max(step, 1)) for k in range(2))
        return GameRecord(
            job=self.job,
            steps=step,
            home=home,
            away=away,
            winner=winner(self._rules, self.options.variant, self.options.steps, home, away),
            events=tuple(sorted(self.events, key=lambda event: event.step)),
            edition=self.options.edition,
        )

    def status(self, rate: float) -> Status:
        """How the game stands, at so many control steps per second."""
        home, away = self.penalties
        return Status(
            key=self.job.key,
            home=self.job.home,
            away=self.job.away,
            step=self.rollout.steps,
            steps=self.options.steps,
            score=self.log.score,
            faults=(self.env.faults[0], self.env.faults[1]),
            penalty=(home.count.points, away.count.points),
            side=self.log.side,
            rate=rate,
        )

    def _serve(self) -> None:
        """Both agents hear of the serve; where it finds them they stay if they are late at once."""
        self.rollout.begin()
        joints, half = self.env.env_info["joint_pos_ids"], self.rollout.observation.size // 2
        for k, seat in enumerate(self.seats):
            seat.position = self.env.true_observation[k * half : (k + 1) * half][joints]
        self.log.serve(self.rollout.steps)

    def _note_late(self, step: int) -> None:
        for seat, penalties in zip(self.seats, self.penalties, strict=True):
            if seat.late:
                penalties.held += 1
                self.log.held(step, seat.side)

    def _end_episode(self, step: int) -> None:
        for penalties in self.penalties:
            self.events.extend(penalties.end_episode(step))

    def _result(self, k: int, steps: int) -> PlayerResult:
        penalties, goals = self.penalties[k], self.log.goals[k]
        return PlayerResult(
            goals=goals,
            points_by_faults=self.log.score[k] - goals,
            faults=self.env.faults[k],
            penalty=penalties.count.points,
            deployability=game_class(self._rules, penalties.count.points, steps),
            violations=dict(penalties.count.violations),
            held=penalties.held,
            computation_time=penalties.computation_time,
            process=self.seats[k].process,
            failure=self.seats[k].failure,
        )


def failed_in_game(failure: BaseException, step: int) -> str:
    """Why a player failed, by the game's control step; an environment's own count begins with the serve."""
    if step == 0:
        return f"episode_start: {describe(failure)}"
    if isinstance(failure, (ActionError, SimulationError)):
        return f"step {step}: {re.sub(r'^step [0-9]+: ', '', str(failure))}"
    return f"step {step}: {describe(failure)}"


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
    on_step: Callable[[Status], None] | None = None
    every: int = 250

    def __call__(self, job: GameJob) -> Game:
        """Play one game from its job alone."""
        with Watch(None if self.live is None else live_file(self.live, job)) as watch:
            game = self.open(job, watch)
            game.film = film = Film(self.options.steps, game.env.base_observation.size)
            gc.collect()
            gc.freeze()  # or a collection in the middle of a game would walk over every module ever imported
            record = game.play(self._reporter(watch))
            for seat in game.seats:
                seat.stop()
            gc.unfreeze()
        return Game(record, film.rows)

    def open(self, job: GameJob, watch: Watch | None = None) -> GamePlay:
        """The players and the table, ready to begin."""
        from airhockey import envs

        secret = self.options.agent_seed
        seed = functools.partial(np.random.SeedSequence, job.seed if secret is None else (int(secret, 16), job.seed))
        given = self.options.isolate, Limits(patience=self.options.patience), None
        seeds = seed(spawn_key=(2, 1)), seed(spawn_key=(2, 2))
        home = Entrant(job.home_agent, job.home_order, *given, seeds[0], job.home_python, job.home_settings)
        away = Entrant(job.away_agent, job.away_order, *given, seeds[1], job.away_python, job.away_settings)
        make = functools.partial(envs.make, "tournament", disturbances=self.profile, edition=self.options.edition)
        care = Care(self.options.clock, TIME_LIMIT, failed_in_game, watch or Watch())
        env, seats = build_seats(make, (home, away), care, seed(spawn_key=(2,)))
        return GamePlay(job, self.options, env, seats)

    def _reporter(self, watch: Watch) -> Callable[[GamePlay], None]:
        """Shows now and then how a game stands."""
        before = time.monotonic()

        def report(game: GamePlay) -> None:
            nonlocal before
            if game.rollout.steps % self.every:
                return
            since, before = before, time.monotonic()
            status = game.status(self.every / max(before - since, 1e-9))
            watch.tell(status)
            if self.on_step is not None:
                self.on_step(status)

        return report


def live_file(folder: Path, job: GameJob) -> Path:
    """Where a game in progress is shown."""
    return folder / file_name(job.key)


def lost(job: GameJob, options: GameOptions, reason: str, guilty: Side | None) -> Game:
    """A game whose worker died every time; it is forfeited by the player whose code ran then, or by both if nobody knows."""
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
        edition=options.edition,
    )
    return Game(record, np.empty((0, 0), dtype=np.float32))
