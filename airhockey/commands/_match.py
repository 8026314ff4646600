"""What `hockey match` does once its options are read."""

import contextlib
import os
import shlex
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import click
import msgspec
from rich.console import Console

from airhockey.agents import AGENTS
from airhockey.commands._evaluation import AGENT_FAILED, INTERRUPTED, RUNS, from_anywhere, stdout_for_the_result
from airhockey.commands._game_tables import print_match
from airhockey.envs.disturbances import available
from airhockey.errors import ConfigurationError
from airhockey.evaluator.cluster import engine_of
from airhockey.evaluator.engines import InProcess
from airhockey.evaluator.games.folder import GameFolder
from airhockey.evaluator.games.match import (
    MatchManifest,
    MatchOptions,
    MatchResult,
    begin_match,
    play_match,
    take_up_match,
)
from airhockey.evaluator.games.play import Status
from airhockey.evaluator.games.records import GameOptions, GameRecord


def run(given: Mapping[str, Any]) -> int:
    """Do what the options say; returns the exit status."""
    engine = engine_of(given["cluster"], given["jobs"] or os.cpu_count() or 1)
    folder = _open(given)
    options = folder.manifest.options
    single = options.games - len(folder.records) == 1 and given["cluster"] is None
    if single:
        engine = InProcess()  # one game: play it here, where it can be watched
    quiet = given["quiet"] or given["as_json"]
    result: MatchResult | None = None
    with contextlib.suppress(KeyboardInterrupt), stdout_for_the_result(), _live(options, quiet) as (on_game, on_step):
        result = play_match(folder, engine, on_game, on_step if single or given["jobs"] == 1 else None)
    if result is None:
        click.echo(
            f"hockey: interrupted after {len(folder.records)} of {options.games} games; continue with:\n"
            f"  hockey match --resume {shlex.quote(str(folder.path))}",
            err=True,
        )
        return INTERRUPTED
    if given["as_json"]:
        click.echo(msgspec.json.encode(result))
    else:
        print_match(result, folder.manifest, folder.path)
    return AGENT_FAILED if any(any(game.failures) for game in result.games) else 0


def game_options_of(given: Mapping[str, Any]) -> GameOptions:
    """How games are played, from the options that match and tournament share."""
    return GameOptions(
        steps=given["steps"],
        disturbances=from_anywhere(given["disturbances"], available()),
        clock=given["clock"],
        variant=given["variant"],
    )


def new_folder(name: str) -> Path:
    """A folder under runs/ that is not there yet."""
    number = 1
    while (RUNS / (name if number == 1 else f"{name}-{number}")).exists():
        number += 1
    return RUNS / (name if number == 1 else f"{name}-{number}")


def _open(given: Mapping[str, Any]) -> GameFolder[MatchManifest]:
    if given["resume"]:
        if given["away"] is not None or given["out"] is not None:
            raise ConfigurationError("--resume takes the match's folder and nothing else: hockey match --resume FOLDER")
        return take_up_match(Path(given["home"]))
    if given["away"] is None:
        raise ConfigurationError("a match takes two players: hockey match A B")
    options = MatchOptions(
        home=from_anywhere(given["home"], AGENTS),
        away=from_anywhere(given["away"], AGENTS),
        games=given["games"],
        seed=given["seed"],
        swap_sides=given["swap_sides"],
        game=game_options_of(given),
    )
    if given["out"] is not None:
        return begin_match(options, Path(given["out"]))
    name = f"match-{Path(options.home).name}-{Path(options.away).name}-s{options.seed}"
    return begin_match(options, new_folder(name))


@contextlib.contextmanager
def _live(options: MatchOptions, quiet: bool) -> Iterator[Any]:
    """What shows how a match goes: a function for every game, and one for a game's steps."""
    if quiet:
        yield None, None
        return
    console = Console(stderr=True, highlight=False)
    played = [0]

    def on_game(record: GameRecord) -> None:
        played[0] += 1
        home, away = record.score
        console.print(
            f"game {played[0]}/{options.games}: {record.job.home} {home} : {away} {record.job.away}, {record.winner}",
            markup=False,
        )

    if not console.is_terminal:
        yield on_game, _lines(console, options.game.steps)
        return
    with console.status("starting; the first time on a machine, the simulator is compiled") as line:
        began = [0.0, 0.0]

        def on_step(status: Status) -> None:
            if status.step < began[1] or not began[0]:
                began[:] = [time.monotonic(), status.step]
            seconds = time.monotonic() - began[0]
            rate = (status.step - began[1]) / seconds if seconds > 0 else 0.0
            line.update(f"{_describe(status)}  {rate:.0f} steps/s")

        yield on_game, on_step


def _lines(console: Console, steps: int) -> Any:
    """Where there is no terminal: a line for every tenth of a game."""
    said = [0]

    def on_step(status: Status) -> None:
        tenth = 10 * status.step // steps
        if tenth != said[0]:
            said[0] = tenth
            console.print(_describe(status), markup=False)

    return on_step


def _describe(status: Status) -> str:
    minutes, seconds = divmod(int(status.step * 0.02), 60)
    home, away = status.score
    return (
        f"{minutes:2d}:{seconds:02d}  score {home}:{away}  faults {status.faults[0]}:{status.faults[1]}  "
        f"penalty {status.penalty[0]:g}:{status.penalty[1]:g}  puck at {status.side}"
    )
