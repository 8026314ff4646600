"""Results of games as tables for people."""

from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table

from airhockey.evaluator.judging.standings import Standings
from airhockey.evaluator.match import GameResult, MatchOptions, MatchResult
from airhockey.evaluator.runs.game_records import Event
from airhockey.evaluator.runs.manifest import Manifest

_WIDTH = 130
_FEW = 8  # events of a game that are shown when several games were played


def output() -> Console:
    """The standard output; what no terminal bounds has room for a table."""
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=_WIDTH)


def print_match(result: MatchResult, manifest: Manifest[MatchOptions], path: Path) -> None:
    """Print a table per game, its events, and the match as a whole."""
    console = output()
    for number, game in enumerate(result.games, start=1):
        console.print(_game_table(result, game, number))
        for side, failure in zip((result.home, result.away), game.failures, strict=True):
            if failure is not None:
                console.print(f"{side} failed: {failure}", markup=False, soft_wrap=True)
        _print_events(console, result, game.events, len(result.games) == 1)
    console.print(f"{result.home}: {result.wins} won, {result.draws} drawn, {result.losses} lost", markup=False)
    versions = ", ".join(f"{name} {version}" for name, version in manifest.versions.items())
    console.print(f"seed {manifest.options.seed}, {versions}", soft_wrap=True)
    console.print(f"stored in {path}", soft_wrap=True, markup=False)


def _game_table(result: MatchResult, game: GameResult, number: int) -> Table:
    title = f"game {number}, {game.steps} steps, disturbances {result.disturbances}: {_outcome(result, game)}"
    table = Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("")
    table.add_column(
        f"{result.home} (home)" if not game.swapped else f"{result.home} (home, on the right)", justify="right"
    )
    table.add_column(f"{result.away} (away)", justify="right")
    for label, values in (
        ("score", game.score),
        ("  goals", game.goals),
        ("  points by the opponent's faults", game.points_by_faults),
        ("faults", game.faults),
    ):
        table.add_row(label, *map(str, values))
    for name in game.violations[0]:
        table.add_row(f"episodes violating {name}", *(str(counts[name]) for counts in game.violations))
    table.add_row("penalty points", *(f"{points:g}" for points in game.penalty))
    table.add_row("deployability", *game.deployability)
    table.add_row("steps with a held command", *map(str, game.held))
    table.add_row("draw_action max", *(f"{seconds * 1e3:.3f} ms" for seconds in game.computation_time_max))
    return table


def _outcome(result: MatchResult, game: GameResult) -> str:
    return "draw" if game.winner == "draw" else f"{result.home if game.winner == 'home' else result.away} wins"


def _print_events(console: Console, result: MatchResult, events: tuple[Event, ...], everything: bool) -> None:
    names = {"home": f"{result.home} (home)", "away": f"{result.away} (away)"}
    told = [event for event in events if event.what not in ("serve", "held")]
    for event in told if everything else told[:_FEW]:
        minutes, seconds = divmod(event.step * 0.02, 60)
        who = f"  {names[event.who]}" if event.who else ""
        score = f"  {event.score[0]}:{event.score[1]}" if event.score else ""
        why = f"  {event.why}" if event.why else ""
        console.print(
            f"{int(minutes):2d}:{seconds:05.2f}  step {event.step:5d}  {event.what:9}{who}{score}{why}",
            markup=False,
            soft_wrap=True,
        )
    if not everything and len(told) > _FEW:
        console.print(f"… and {len(told) - _FEW} more events, in the journal")


def print_standings(console: Console, table: Standings) -> None:
    """Print the standings of a tournament."""
    title = f"standings after {table.played} of {table.games} games"
    shown = Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    for name in ("#", "entry", "played", "won", "drawn", "lost", "goals", "diff.", "points", "penalty", "rating"):
        shown.add_column(name, justify="left" if name == "entry" else "right")
    for row in table.rows:
        shown.add_row(
            str(row.rank),
            row.name,
            str(row.played),
            str(row.won),
            str(row.drawn),
            str(row.lost),
            f"{row.goals}:{row.conceded}",
            f"{row.difference:+d}",
            str(row.points),
            f"{row.penalty:g}",
            f"{row.rating:.1f} ± {row.uncertainty:.1f}",
        )
    console.print(shown)
