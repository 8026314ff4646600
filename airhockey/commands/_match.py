"""What `hockey match` does once its options are read."""

import contextlib
import shlex
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import click
import msgspec

from airhockey.agents import AGENTS
from airhockey.commands._evaluation import AGENT_FAILED, INTERRUPTED, RUNS, cpus, from_anywhere, stdout_for_the_result
from airhockey.commands._game_tables import print_match
from airhockey.commands._isolation import say_what_is_not_protected
from airhockey.commands._live import games_live
from airhockey.envs.disturbances import available
from airhockey.evaluator.engines.cluster import engine_of
from airhockey.evaluator.match import (
    MatchFolder,
    MatchOptions,
    MatchResult,
    begin_match,
    play_match,
    resume_match,
)
from airhockey.evaluator.runs.game_records import GameOptions

GAME_OPTIONS = ("steps", "disturbances", "clock", "variant", "isolate", "patience")
_OWN = ("games", "seed", "swap_sides", *GAME_OPTIONS)


def run(given: Mapping[str, Any], typed: set[str]) -> int:
    """Do what the options say.

    Args:
        given: Every option's value by its name.
        typed: Names of those that the user typed.

    Returns:
        The exit status.
    """
    engine = engine_of(given["cluster"], min(given["jobs"] or cpus(), given["games"]), isolated=True)
    folder = _open(given, typed)
    if not given["resume"]:
        say_what_is_not_protected((folder.manifest.options.home, folder.manifest.options.away), given["isolate"])
    games, before = folder.manifest.options.games, len(folder.records)
    quiet = given["quiet"] or given["as_json"]
    result: MatchResult | None = None
    with (
        contextlib.suppress(KeyboardInterrupt),
        stdout_for_the_result(),
        games_live(folder.live, games, before, quiet) as view,
    ):
        result = play_match(folder, engine, view.add if view is not None else None)
    if result is None:
        click.echo(
            f"hockey: interrupted after {len(folder.records)} of {games} games; continue with:\n"
            f"  hockey match --resume --out {shlex.quote(str(folder.path))}",
            err=True,
        )
        return INTERRUPTED
    if given["as_json"]:
        click.echo(msgspec.json.encode(result))
        if not given["quiet"]:
            click.echo(f"hockey: stored in {folder.path}", err=True)
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
        isolate=given["isolate"] or "auto",
        patience=given["patience"],
    )


def new_folder(name: str) -> Path:
    """A folder under runs/ that is not there yet."""
    number = 1
    while (RUNS / (name if number == 1 else f"{name}-{number}")).exists():
        number += 1
    return RUNS / (name if number == 1 else f"{name}-{number}")


def repeated(options: msgspec.Struct, game: GameOptions, names: Iterable[str], typed: set[str]) -> dict[str, Any]:
    """Those options of what is taken up that the user typed again, by name."""
    return {name: getattr(game if name in GAME_OPTIONS else options, name) for name in names if name in typed}


def _open(given: Mapping[str, Any], typed: set[str]) -> MatchFolder:
    """The match to take up, or a new one."""
    sides = {side for side in ("home", "away") if given[side] is not None}
    options = MatchOptions(
        home=from_anywhere(given["home"] or "", AGENTS),
        away=from_anywhere(given["away"] or "", AGENTS),
        games=given["games"],
        seed=given["seed"],
        swap_sides=given["swap_sides"],
        game=game_options_of(given),
    )
    if given["resume"]:
        return resume_match(Path(given["out"]), repeated(options, options.game, (*sides, *_OWN), typed | sides))
    if given["out"] is not None:
        return begin_match(options, Path(given["out"]))
    name = f"match-{Path(options.home).name}-{Path(options.away).name}-s{options.seed}"
    return begin_match(options, new_folder(name))
