"""What `hockey tournament` does once its options are read."""

import contextlib
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click
import msgspec
import yaml

from airhockey.agents import AGENTS
from airhockey.commands._evaluation import AGENT_FAILED, INTERRUPTED, cpus, from_anywhere, stdout_for_the_result
from airhockey.commands._game_tables import output, print_standings
from airhockey.commands._isolation import say_what_is_not_protected
from airhockey.commands._live import games_live
from airhockey.commands._match import GAME_OPTIONS, game_options_of, new_folder, repeated
from airhockey.errors import ConfigurationError
from airhockey.evaluator.engines.cluster import engine_of
from airhockey.evaluator.engines.engine import Engine
from airhockey.evaluator.isolation.modes import REMOTE
from airhockey.evaluator.judging.standings import Standings, as_csv
from airhockey.evaluator.runs.game_records import GameRecord
from airhockey.evaluator.schedule import Entry, TournamentOptions, entry_of, schedule, with_replacements
from airhockey.evaluator.tournament import (
    TournamentFolder,
    begin_tournament,
    play_tournament,
    read_standings,
    resume_tournament,
)

_OWN = ("seed", *GAME_OPTIONS)


class EntriesFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A YAML file of entries, where it is not simply a list of them."""

    entries: list[Entry]


def run(given: Mapping[str, Any], typed: set[str]) -> int:
    """Do what the options say.

    Args:
        given: Every option's value by its name.
        typed: Names of those that the user typed.

    Returns:
        The exit status.
    """
    if given["show"]:
        _, table = read_standings(Path(given["out"]))
        _print(table, given)
        return 0
    engine = engine_of(given["cluster"], given["jobs"] or cpus(), isolated=True)
    folder = _open(given, typed)
    if not given["resume"]:
        say_what_is_not_protected((entry.agent for entry in folder.manifest.options.entries), given["isolate"])
    played = _play(folder, engine, given)
    if played is None:
        click.echo(
            f"hockey: interrupted after {len(folder.records)} games; continue with:\n"
            f"  hockey tournament --resume --out {shlex.quote(str(folder.path))}",
            err=True,
        )
        return INTERRUPTED
    _print(played, given)
    if not given["quiet"]:
        click.echo(f"hockey: stored in {folder.path}", err=True)
    return AGENT_FAILED if any(row.forfeits for row in played.rows) else 0


def _play(folder: TournamentFolder, engine: Engine, given: Mapping[str, Any]) -> Standings | None:
    """The final standings; None if the user did not want to wait for them."""
    games, before = len(schedule(folder.manifest.options)), len(folder.records)
    quiet = given["quiet"] or given["as_json"] or given["as_csv"]
    with (
        contextlib.suppress(KeyboardInterrupt),
        stdout_for_the_result(),
        games_live(folder.live, games, before, quiet) as view,
    ):

        def on_standings(record: GameRecord, standings: Standings) -> None:
            if view is not None:
                view.add(record)
                if view.console.is_terminal:
                    print_standings(view.console, standings)

        return play_tournament(folder, engine, on_standings)
    return None


def _print(table: Standings, given: Mapping[str, Any]) -> None:
    if given["as_json"]:
        click.echo(msgspec.json.encode(table))
    elif given["as_csv"]:
        click.echo(as_csv(table), nl=False)
    else:
        print_standings(output(), table)


def _open(given: Mapping[str, Any], typed: set[str]) -> TournamentFolder:
    """The tournament to take up, perhaps extended, or a new one."""
    entries, replacements = _entries(given), _replacements(given)
    options = TournamentOptions(
        entries=entries, phases=given["phases"], seed=given["seed"], game=game_options_of(given)
    )
    if given["resume"]:
        asked = repeated(options, options.game, _OWN, typed)
        phases = given["phases"] if "phases" in typed else None
        return resume_tournament(Path(given["out"]), entries, asked, phases, replacements)
    options = msgspec.structs.replace(options, entries=with_replacements(entries, replacements))
    out = Path(given["out"]) if given["out"] is not None else new_folder(f"tournament-s{options.seed}")
    return begin_tournament(options, out)


def _entries(given: Mapping[str, Any]) -> tuple[Entry, ...]:
    entries = [entry_of(text) for text in given["entries"]]
    if given["entries_file"] is not None:
        entries += _read_entries(Path(given["entries_file"]))
    return tuple(_resolved(entry) for entry in entries)


def _replacements(given: Mapping[str, Any]) -> dict[str, str]:
    replacements = {}
    for text in given["replace"]:
        name, equals, agent = text.partition("=")
        if not equals or not agent:
            raise ConfigurationError(f"--replace {text!r}: write NAME=AGENT")
        replacements[name] = from_anywhere(agent, AGENTS)
    return replacements


def _resolved(entry: Entry) -> Entry:
    second = None if entry.second_agent is None else from_anywhere(entry.second_agent, AGENTS)
    return msgspec.structs.replace(entry, agent=from_anywhere(entry.agent, AGENTS), second_agent=second)


def _read_entries(path: Path) -> list[Entry]:
    """Entries from a YAML file: a list, or a mapping with the key `entries`; paths are relative to the file."""
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
        listed = content if isinstance(content, dict) else {"entries": content}
        entries = msgspec.convert(listed, EntriesFile).entries
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigurationError(f"cannot read the entries in {str(path)!r}: {error}") from error
    except (yaml.YAMLError, msgspec.ValidationError) as error:
        raise ConfigurationError(
            f"the entries in {str(path)!r} are not valid: {' '.join(str(error).split())}"
        ) from error
    return [_relative_to(path.parent, entry) for entry in entries]


def _relative_to(folder: Path, entry: Entry) -> Entry:
    def located(agent: str | None) -> str | None:
        return (
            agent
            if agent is None or agent in AGENTS or agent.startswith(REMOTE)
            else str(folder / Path(agent).expanduser())
        )

    return msgspec.structs.replace(entry, agent=str(located(entry.agent)), second_agent=located(entry.second_agent))
