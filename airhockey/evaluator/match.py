"""A match: some games of one pair of players."""

import contextlib
from collections.abc import Callable, Mapping
from typing import Any

import msgspec

from airhockey.envs.editions import DEFAULT
from airhockey.errors import ConfigurationError
from airhockey.evaluator.checks import check_agent, check_game_options, check_seed, check_settings
from airhockey.evaluator.engines.engine import Engine, InProcess
from airhockey.evaluator.engines.pool import JobFailed
from airhockey.evaluator.isolation.modes import check_python
from airhockey.evaluator.judging.games import tally
from airhockey.evaluator.play.blame import worker_lost
from airhockey.evaluator.play.game import Game, GamePlayer, live_file, lost
from airhockey.evaluator.play.seeding import game_seed
from airhockey.evaluator.play.watchdog import culprit
from airhockey.evaluator.runs import notebook
from airhockey.evaluator.runs.game_folder import GameFolder
from airhockey.evaluator.runs.game_records import (
    Event,
    GameJob,
    GameOptions,
    GameRecord,
    PlayerResult,
    Side,
    Winner,
    in_order,
)
from airhockey.evaluator.runs.manifest import MATCH
from airhockey.evaluator.runs.records import Order, PreparationTime

OnGame = Callable[[GameRecord], None]


class MatchOptions(msgspec.Struct, frozen=True, kw_only=True):
    """What a match is.

    Attributes:
        home, away: Names of the registry, or absolute paths of submissions. "Home" is player 1 unless sides are swapped.
        games: How many.
        seed: Every game's seed comes from it and the game's number.
        swap_sides: In every second game the away player plays on the left.
        game: How each is played.
        home_order, away_order: Interpolation orders.
        python: Of home and away: another interpreter for a submission's process.
        settings: Of home and away: of our own players' controllers.
    """

    home: str
    away: str
    games: int = 1
    seed: int = 0
    swap_sides: bool = False
    game: GameOptions = GameOptions()
    home_order: Order = "agent"
    away_order: Order = "agent"
    python: tuple[str | None, str | None] = (None, None)
    settings: tuple[tuple[str, ...], tuple[str, ...]] = ((), ())


class GameResult(msgspec.Struct, frozen=True, kw_only=True):
    """One game as `--json` prints it, seen from the match: home is the match's first player, whichever side it played on."""

    seed: int
    steps: int
    swapped: bool
    score: tuple[int, int]
    goals: tuple[int, int]
    points_by_faults: tuple[int, int]
    faults: tuple[int, int]
    penalty: tuple[float, float]
    deployability: tuple[str, str]
    violations: tuple[dict[str, int], dict[str, int]]
    computation_time_mean: tuple[float, float]
    computation_time_max: tuple[float, float]
    held: tuple[int, int]
    failures: tuple[str | None, str | None]
    isolation: tuple[str, str] = ("", "")
    preparation_time: tuple[PreparationTime, PreparationTime] = (PreparationTime(), PreparationTime())
    winner: Winner
    events: tuple[Event, ...]


class MatchResult(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """What `hockey match --json` prints: the games, how home fared in them, and the manifest's `inputs`."""

    home: str
    away: str
    disturbances: str
    games: tuple[GameResult, ...]
    wins: int
    draws: int
    losses: int
    inputs: dict[str, str] = {}
    edition: str = DEFAULT

    def _repr_html_(self) -> str:
        return notebook.table(
            f"{self.home} – {self.away}: {self.wins} won, {self.draws} drawn, {self.losses} lost",
            ("game", "score", "goals", "faults", "penalty", "winner"),
            (
                (number, *("{} : {}".format(*of) for of in (game.score, game.goals, game.faults)),
                 "{:g} : {:g}".format(*game.penalty), game.winner)
                for number, game in enumerate(self.games, start=1)
            ),
        )  # fmt: skip


class MatchFolder(GameFolder[MatchOptions]):
    """The folder of a match, opened for writing."""

    name, options_type = MATCH, MatchOptions

    @classmethod
    def check(cls, options: MatchOptions) -> None:
        """Find the mistakes in a match's options; raises `ConfigurationError`."""
        check_game_options(options.game)
        check_seed(options.seed)
        if options.games < 1:
            raise ConfigurationError(f"the number of games must be positive, not {options.games}")
        for agent, python, settings in zip((options.home, options.away), options.python, options.settings, strict=True):
            check_agent(agent, ("tournament",))
            check_python(agent, options.game.isolate, python)
            check_settings(agent, settings)


begin_match = MatchFolder.begin
resume_match = MatchFolder.resume


def match_jobs(options: MatchOptions) -> list[GameJob]:
    """The games of a match."""
    jobs = []
    for index in range(options.games):
        job = GameJob(
            str(index),
            options.home,
            options.away,
            options.home,
            options.away,
            game_seed(options.seed, str(index)),
            options.home_order,
            options.away_order,
            *options.python,
            *options.settings,
        )
        jobs.append(job.swapped() if options.swap_sides and index % 2 else job)
    return jobs


def play_match(folder: MatchFolder, engine: Engine | None = None, on_game: OnGame | None = None) -> MatchResult:
    """Play the games that are not played yet, and report on all of them.

    Args:
        folder: From `begin_match` or `resume_match`; it is closed afterwards.
        engine: Where the games are played; here, one after the other, if not given.
        on_game: Called with every record as it comes.
    """
    options = folder.manifest.options
    with folder:
        play_games(folder, match_jobs(options), engine, on_game)
        result = match_result(options, folder.records, folder.manifest.inputs)
        folder.keep_result(result)
    return result


def play_games(
    folder: GameFolder[Any], jobs: list[GameJob], engine: Engine | None = None, on_game: OnGame | None = None
) -> None:
    """Play those of the jobs that the folder does not hold yet, and keep each as it ends."""
    folder.check_work(job.key for job in jobs)
    player = GamePlayer(folder.manifest.options.game, folder.manifest.profile, folder.live.resolve())
    missing = [job for job in jobs if job.key not in folder.done]
    results = (engine or InProcess()).run(player, missing)
    with contextlib.closing(results):
        for job, result in results:
            folder.add(_game_of(job, result, player))
            if on_game is not None:
                on_game(folder.records[-1])


def _game_of(job: GameJob, result: Game | JobFailed, player: GamePlayer) -> Game:
    if not isinstance(result, JobFailed):
        return result
    worker_lost((job.home_agent, job.away_agent), player.options.isolate, result.reason)
    guilty = None if player.live is None else culprit(live_file(player.live, job))
    return lost(job, player.options, result.reason, guilty)


def match_result(
    options: MatchOptions, records: list[GameRecord], inputs: Mapping[str, str] | None = None
) -> MatchResult:
    """The match from its games, in their order."""
    jobs = match_jobs(options)
    games = tuple(
        _seen_from_home(record, swapped=options.swap_sides and int(record.job.key) % 2 == 1)
        for record in in_order(records, [job.key for job in jobs])
    )
    wins, draws, losses = tally([game.winner for game in games])
    return MatchResult(
        home=options.home,
        away=options.away,
        disturbances=options.game.disturbances,
        games=games,
        wins=wins,
        draws=draws,
        losses=losses,
        inputs=dict(inputs or {}),
        edition=options.game.edition,
    )


def _seen_from_home(record: GameRecord, swapped: bool) -> GameResult:
    home, away = (record.away, record.home) if swapped else (record.home, record.away)
    winner: Winner = record.winner
    if swapped and winner != "draw":
        winner = "away" if winner == "home" else "home"
    return GameResult(
        seed=record.job.seed,
        steps=record.steps,
        swapped=swapped,
        score=(home.points, away.points),
        goals=(home.goals, away.goals),
        points_by_faults=(home.points_by_faults, away.points_by_faults),
        faults=(home.faults, away.faults),
        penalty=(home.penalty, away.penalty),
        deployability=(home.deployability, away.deployability),
        violations=(home.violations, away.violations),
        computation_time_mean=(home.computation_time.mean, away.computation_time.mean),
        computation_time_max=(home.computation_time.max, away.computation_time.max),
        held=(home.held, away.held),
        failures=(home.failure, away.failure),
        isolation=(home.process.isolation, away.process.isolation),
        preparation_time=(_preparation_time(home), _preparation_time(away)),
        winner=winner,
        events=record.events if not swapped else tuple(_swapped(event) for event in record.events),
    )


def _preparation_time(player: PlayerResult) -> PreparationTime:
    return PreparationTime(build_agent=player.process.build_time, episode_start=player.process.start_time)


def _swapped(event: Event) -> Event:
    who: Side | None = None if event.who is None else ("away" if event.who == "home" else "home")
    score = None if event.score is None else (event.score[1], event.score[0])
    return msgspec.structs.replace(event, who=who, score=score)
