"""What `hockey tournament` does once its options are read."""

import contextlib
import os
import shlex
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import click
import msgspec
import yaml
from rich.console import Console

from airhockey.agents import AGENTS
from airhockey.commands._evaluation import AGENT_FAILED, INTERRUPTED, from_anywhere, stdout_for_the_result
from airhockey.commands._game_tables import print_standings
from airhockey.commands._match import game_options_of, new_folder
from airhockey.errors import ConfigurationError
from airhockey.evaluator.cluster import engine_of
from airhockey.evaluator.games.folder import GameFolder
from airhockey.evaluator.games.records import GameRecord
from airhockey.evaluator.games.standings import Standings
from airhockey.evaluator.games.tournament import (
    Entry,
    TournamentManifest,
    TournamentOptions,
    begin_tournament,
    entry_of,
    play_tournament,
    read_standings,
    take_up_tournament,
    with_replacements,
)


def run(given: Mapping[str, Any]) -> int:
    """Do what the options say; returns the exit status."""
    if given["show"]:
        return _show(given)
    engine = engine_of(given["cluster"], given["jobs"] or os.cpu_count() or 1)
    folder = _open(given)
    table: Standings | None = None
    console = Console(stderr=True, highlight=False)

    def on_standings(record: GameRecord, standings: Standings) -> None:
        home, away = record.score
        console.print(
            f"{standings.played}/{standings.games}  {record.job.home} {home} : {away} {record.job.away}", markup=False
        )
        if console.is_terminal:
            print_standings(console, standings)

    quiet = given["quiet"] or given["as_json"]
    with contextlib.suppress(KeyboardInterrupt), stdout_for_the_result():
        table = play_tournament(folder, engine, None if quiet else on_standings)
    if table is None:
        click.echo(
            f"hockey: interrupted after {len(folder.records)} games; continue with:\n"
            f"  hockey tournament --resume --out {shlex.quote(str(folder.path))}",
            err=True,
        )
        return INTERRUPTED
    _print(table, given["as_json"])
    if not given["as_json"]:
        click.echo(f"stored in {folder.path}")
    return AGENT_FAILED if any(row.forfeits for row in table.rows) else 0


def _show(given: Mapping[str, Any]) -> int:
    if given["out"] is None:
        raise ConfigurationError("--show needs the tournament's folder: --out FOLDER")
    _, table = read_standings(Path(given["out"]))
    _print(table, given["as_json"])
    return 0


def _print(table: Standings, as_json: bool) -> None:
    if as_json:
        click.echo(msgspec.json.encode(table))
    else:
        print_standings(Console(highlight=False), table)


def _open(given: Mapping[str, Any]) -> GameFolder[TournamentManifest]:
    entries = tuple(_resolved(entry) for entry in _entries(given))
    if given["resume"]:
        if given["out"] is None:
            raise ConfigurationError("--resume needs the tournament's folder: --out FOLDER")
        return take_up_tournament(Path(given["out"]), entries)
    options = TournamentOptions(
        entries=entries, phases=given["phases"], seed=given["seed"], game=game_options_of(given)
    )
    out = Path(given["out"]) if given["out"] is not None else new_folder(f"tournament-s{options.seed}")
    return begin_tournament(options, out)


def _entries(given: Mapping[str, Any]) -> Iterable[Entry]:
    entries = [entry_of(text) for text in given["entries"]]
    if given["entries_file"] is not None:
        entries += _read_entries(Path(given["entries_file"]))
    replacements = {}
    for text in given["replace"]:
        name, equals, agent = text.partition("=")
        if not equals or not agent:
            raise ConfigurationError(f"--replace {text!r}: write NAME=AGENT")
        replacements[name] = agent
    return with_replacements(entries, replacements)


def _resolved(entry: Entry) -> Entry:
    second = None if entry.second_agent is None else from_anywhere(entry.second_agent, AGENTS)
    return msgspec.structs.replace(entry, agent=from_anywhere(entry.agent, AGENTS), second_agent=second)


def _read_entries(path: Path) -> list[Entry]:
    """Entries from a YAML file: a list, or a mapping with the key `entries`; paths are relative to the file."""
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
        entries = msgspec.convert(content.get("entries") if isinstance(content, dict) else content, list[Entry])
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigurationError(f"cannot read the entries in {str(path)!r}: {error}") from error
    except (yaml.YAMLError, msgspec.ValidationError) as error:
        raise ConfigurationError(
            f"the entries in {str(path)!r} are not valid: {' '.join(str(error).split())}"
        ) from error
    return [_relative_to(path.parent, entry) for entry in entries]


def _relative_to(folder: Path, entry: Entry) -> Entry:
    def located(agent: str | None) -> str | None:
        return agent if agent is None or agent in AGENTS else str(folder / agent)

    return msgspec.structs.replace(entry, agent=str(located(entry.agent)), second_agent=located(entry.second_agent))
