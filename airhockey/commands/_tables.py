"""Results as tables for people."""

from collections.abc import Mapping
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table

from airhockey.envs.editions import edition
from airhockey.evaluator import RunResult, TaskResult
from airhockey.evaluator.analysis.failures import causes_of
from airhockey.evaluator.evaluation import failure_reasons
from airhockey.evaluator.judging.standings import Standings
from airhockey.evaluator.judging.tasks import OFFICIAL_EPISODES, judge, wilson_interval
from airhockey.evaluator.match import GameResult, MatchFolder, MatchResult
from airhockey.evaluator.runs.episode_folder import EpisodeFolder
from airhockey.evaluator.runs.folder import RunFolder
from airhockey.evaluator.runs.game_records import Event
from airhockey.inputs.names import shown

_WIDTH = 130
_FEW = 8  # events of a game that are shown when several games were played


def output() -> Console:
    """The standard output; what no terminal bounds has room for a table."""
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=_WIDTH)


def print_result(result: TaskResult | RunResult, folder: EpisodeFolder) -> None:
    """Print the table, what went wrong, and where everything is stored."""
    console = Console(highlight=False)
    tasks = result.tasks
    console.print(_table(tasks, folder))
    if isinstance(result, RunResult):
        score = "" if result.score is None else f", {result.phase} score {result.score:.3f}"
        console.print(f"overall: {result.deployability}{score}")
    for isolation in dict.fromkeys(task.isolation for task in tasks if task.isolation not in ("", "none")):
        console.print(f"isolation: {shown(isolation, 500)}", markup=False)
    for reason, episodes in failure_reasons(folder.path):
        console.print(f"agent failed {episodes} episode{'s' if episodes > 1 else ''}: {reason}", markup=False)
    _print_origin(console, folder)
    if any(causes_of(record) for record in folder.records):
        console.print(f"what went wrong: hockey failures {folder.path}", markup=False, soft_wrap=True)


def _table(tasks: tuple[TaskResult, ...], folder: EpisodeFolder) -> Table:
    options = folder.manifest.options
    rules = edition(options.edition)
    verdicts = [judge([record for record in folder.records if record.env == task.env], rules) for task in tasks]
    title = f"agent {options.agent}, {options.episodes} episodes, {_conditions(options.edition, options.disturbances)}"
    table = _titled(title)
    table.add_column("")
    for task in tasks:
        table.add_column(task.env, justify="right")
    table.add_row("success", *(f"{task.success:.1%}" for task in tasks))
    table.add_row("  95 % interval", *map(_interval, tasks))
    for name in dict.fromkeys(name for task in tasks for name in task.violations):
        table.add_row(f"episodes violating {name}", *(str(task.violations.get(name, "–")) for task in tasks))
    table.add_row("episodes violating computation_time", *(str(verdict.late) for verdict in verdicts))
    table.add_row("penalty points", *(f"{task.penalty:g}" for task in tasks))
    table.add_row("deployability", *(task.deployability for task in tasks))
    if options.episodes != OFFICIAL_EPISODES:
        table.add_row(
            f"  at this rate, {OFFICIAL_EPISODES} episodes",
            *(verdict.official_class for verdict in verdicts),
        )
    for name in ("mean", "p99", "max"):
        label = f"draw_action {name}, {options.clock} clock"
        table.add_row(label, *(f"{getattr(task.computation_time, name) * 1e3:.3f} ms" for task in tasks))
    table.add_row("steps over 20 ms", *(str(task.computation_time.late) for task in tasks))
    for name in ("build_agent", "episode_start"):
        table.add_row(f"longest {name}", *(f"{getattr(task.preparation_time, name):.3f} s" for task in tasks))
    table.add_row("episodes failed by the agent", *(str(task.agent_errors) for task in tasks))
    return table


def _interval(task: TaskResult) -> str:
    low, high = wilson_interval(round(task.success * task.episodes), task.episodes)
    return f"{low:.1%} – {high:.1%}"


def print_match(result: MatchResult, folder: MatchFolder) -> None:
    """Print a table per game, its events, and the match as a whole."""
    console = output()
    for number, game in enumerate(result.games, start=1):
        console.print(_game_table(result, game, number, folder.manifest.options.game.clock))
        for side, isolation in zip((result.home, result.away), game.isolation, strict=True):
            if isolation not in ("", "none"):
                console.print(f"{side} ran in a {shown(isolation, 500)}", markup=False, soft_wrap=True)
        for side, failure in zip((result.home, result.away), game.failures, strict=True):
            if failure is not None:
                console.print(f"{side} failed: {failure}", markup=False, soft_wrap=True)
        _print_events(console, result, game.events, len(result.games) == 1)
    console.print(f"{result.home}: {result.wins} won, {result.draws} drawn, {result.losses} lost", markup=False)
    _print_origin(console, folder)


def _game_table(result: MatchResult, game: GameResult, number: int, clock: str) -> Table:
    title = f"game {number}, {game.steps} steps, {_conditions(result.edition, result.disturbances)}: {_outcome(result, game)}"
    table = _titled(title)
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
    for name in ("build_agent", "episode_start"):
        table.add_row(f"longest {name}", *(f"{getattr(times, name):.3f} s" for times in game.preparation_time))
    for name, times in (("mean", game.computation_time_mean), ("max", game.computation_time_max)):
        table.add_row(f"draw_action {name}, {clock} clock", *(f"{seconds * 1e3:.3f} ms" for seconds in times))
    table.add_row("steps over 20 ms: command held", *map(str, game.held))
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
    title = f"standings after {table.played} of {table.games} games, edition {table.edition}"
    shown = _titled(title)
    for name in (
        "#",
        "entry",
        "played",
        "won",
        "drawn",
        "lost",
        "points",
        "score",
        "goals",
        "by faults",
        "penalty",
        "rating",
    ):
        shown.add_column(name, justify="left" if name == "entry" else "right")
    for row in table.rows:
        shown.add_row(
            str(row.rank),
            row.name,
            str(row.played),
            str(row.won),
            str(row.drawn),
            str(row.lost),
            str(row.points),
            f"{row.points_for}:{row.points_against}",
            f"{row.goals}:{row.conceded}",
            str(row.by_faults),
            f"{row.penalty:g}",
            f"{row.rating:.1f} ± {row.uncertainty:.1f}",
        )
    console.print(shown)


def _conditions(edition: str, disturbances: str) -> str:
    """Under which results can be compared."""
    return f"edition {edition}, disturbances {disturbances}"


def _titled(title: str) -> Table:
    return Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)


def _print_origin(console: Console, folder: RunFolder[Any, Any]) -> None:
    """Where a result comes from, and where it is stored."""
    versions = ", ".join(f"{name} {version}" for name, version in folder.manifest.versions.items())
    console.print(f"seed {folder.manifest.options.seed}, {versions}", soft_wrap=True)
    print_inputs(console, folder.manifest.inputs)
    console.print(f"stored in {folder.path}", soft_wrap=True, markup=False)


def print_inputs(console: Console, inputs: Mapping[str, str]) -> None:
    """Agents and files of a run, by their content."""
    for name, digest in inputs.items():
        console.print(f"{shown(name)}: SHA-256 {digest}", soft_wrap=True, markup=False)
