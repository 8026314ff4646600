"""`hockey tournament`: everybody against everybody, at home and away."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import rich_click as click

from airhockey.commands import _options as common

if TYPE_CHECKING:
    from airhockey.commands._live import View
    from airhockey.evaluator.entries import Entry
    from airhockey.evaluator.judging.standings import Standings
    from airhockey.evaluator.runs.game_records import GameRecord


@click.command()
@click.argument("entries", metavar="[NAME=]AGENT…", nargs=-1)
@click.option(
    "--entries-file",
    metavar="FILE",
    help="A YAML file with a list of entries (name, agent, second_agent, python, settings).",
)
@click.option("--phases", type=click.IntRange(1, 2), default=1, show_default=True, help="Double round robins.")
@click.option("--replace", metavar="NAME=AGENT", multiple=True, help="Another agent for an entry in phase 2.")
@click.option("--show", is_flag=True, help="Show the standings of the tournament in --out without playing.")
@click.option("--csv", "as_csv", is_flag=True, help="Print the standings as comma-separated values, and nothing else.")
@common.options(*common.GAMES)
@click.pass_context
def tournament(ctx: click.RichContext, /, **given: Any) -> None:
    """Play a tournament: a double round robin of whole games, with standings and ratings after each.

    3 points for a win, 1 for a draw; ties are broken by the score: difference, then points; by the games among those tied,
    fewer penalty points, name. With --resume a tournament that was stopped goes on, and one that is finished can be
    extended: by entries, or by --phases 2 with or without --replace. Only the missing games are played. Exit status 3: an
    entry failed games, and so lost them.

    \b
    hockey tournament thesis planner hold --steps 5000
    hockey tournament alpha=submissions/alpha beta=submissions/beta
    hockey tournament --resume --out runs/tournament-s0 --phases 2 --replace beta=submissions/beta2
    hockey tournament --resume --out runs/tournament-s0 thesis
    hockey tournament --show --out runs/tournament-s0
    """
    typed = common.typed_options(ctx, given)
    if given["show"] and given["out"] is None:
        raise click.UsageError("--show needs the tournament's folder: --out FOLDER")
    if given["as_json"] and given["as_csv"]:
        raise click.UsageError("--json or --csv, not both")
    from airhockey.commands import _live
    from airhockey.commands._session import AGENT_FAILED, Session, game_options_of
    from airhockey.evaluator import entries as entering
    from airhockey.evaluator import schedule, tournament

    if given["show"]:
        ctx.exit(_print(tournament.read_standings(Path(given["out"]))[1], given))
    session = Session("tournament", given, typed - {"entries", "phases"})
    engine = session.engine(isolated=True)
    entries, replacements = _entries(given), _replacements(given)
    options = schedule.TournamentOptions(
        entries=entries if given["resume"] else entering.with_replacements(entries, replacements),
        phases=given["phases"],
        seed=given["seed"],
        game=game_options_of(given, {entry.agent: entry.python for entry in entries}),
    )
    extension = entries, given["phases"] if "phases" in typed else None, replacements
    folder = session.open(
        options,
        f"tournament-s{options.seed}",
        tournament.begin_tournament,
        lambda path, asked: tournament.resume_tournament(path, extension[0], asked, *extension[1:]),
        (entry.agent for entry in entries),
    )
    games = len(schedule.schedule(folder.manifest.options))

    def show(standings: "Standings") -> int:
        _print(standings, given)
        session.say_where(folder)
        return AGENT_FAILED if any(row.forfeits for row in standings.rows) else 0

    def play(view: "View") -> "Standings":
        return tournament.play_tournament(folder, engine, partial(_show_game, view))

    progress = _live.of_games(folder.live, games, len(folder.records), session.quiet)
    ctx.exit(session.run(folder, f"{games} games", progress, play, show))


def _show_game(view: "View", record: "GameRecord", standings: "Standings") -> None:
    from airhockey.commands import _tables

    view.add(record)
    if view.console.is_terminal:
        _tables.print_standings(view.console, standings)


def _print(standings: "Standings", given: dict[str, Any]) -> int:
    import msgspec

    from airhockey.commands import _tables
    from airhockey.evaluator.judging.standings import as_csv

    if given["as_json"]:
        click.echo(msgspec.json.encode(standings))
    elif given["as_csv"]:
        click.echo(as_csv(standings), nl=False)
    else:
        console = _tables.output()
        _tables.print_standings(console, standings)
        _tables.print_inputs(console, standings.inputs)
    return 0


def _entries(given: dict[str, Any]) -> "tuple[Entry, ...]":
    """The entries that were typed and those of the file, with full paths."""
    import msgspec

    from airhockey.commands._players import pythons_of, settings_of
    from airhockey.commands._session import agent_of, python_of
    from airhockey.evaluator.entries import entry_of, read_entries

    entries = [entry_of(text) for text in given["entries"]]
    if given["entries_file"] is not None:
        entries += read_entries(Path(given["entries_file"]))
    agents = {entry.name: agent_of(entry.agent) for entry in entries}
    pythons, settings = pythons_of(given, agents), settings_of(given, agents)
    return tuple(
        msgspec.structs.replace(
            entry,
            agent=agent_of(entry.agent),
            second_agent=entry.second_agent and agent_of(entry.second_agent),
            python=pythons[entry.name] or python_of(entry.python),
            settings=settings[entry.name] or entry.settings,
        )
        for entry in entries
    )


def _replacements(given: dict[str, Any]) -> dict[str, str]:
    from airhockey.commands._session import agent_of
    from airhockey.errors import ConfigurationError

    replacements = {}
    for text in given["replace"]:
        name, equals, agent = text.partition("=")
        if not equals or not agent:
            raise ConfigurationError(f"--replace {text!r}: write NAME=AGENT")
        replacements[name] = agent_of(agent)
    return replacements
