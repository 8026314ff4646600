"""Sections of the page for the thesis's tables: what is printed, and what the same player does here."""

from pathlib import Path

import msgspec

from airhockey.evaluator import evaluation
from airhockey.evaluator.judging.tasks import wilson_interval
from airhockey.evaluator.match import MatchResult
from airhockey.evaluator.runs.records import RunResult, TaskResult
from airhockey.reporting.blocks import paragraphs, section, table
from airhockey.reporting.markup import Markup
from airhockey.reproduction.printed import COLUMNS, GAMES, QUALIFYING, WARM_UP

_WHY_TASKS = (
    "Printed is one evaluation on the organisers' server, whose disturbances are not published; here the profile “server” stands "
    "for them. “Text alone” plays what chapter 4 says and nothing else: numbers that it does not print are this project's "
    "(agents/thesis/thesis.yaml says which). Its penalties are far lower, because every command goes through this project's "
    "anchored QP, which keeps the joints' limits. “Tuned” has this project's additions and parameters.",
)
_WHY_GAMES = (
    "Printed is one game of 45,000 steps against the organisers' baseline, which is not part of this package: “ordinary” plays "
    "in its style. The first three printed games were local, the last on the server; here all have the profile “server”. A count "
    "is the number of 500-step episodes in which the constraint was violated, scaled to 45,000 steps.",
)


def task_section(part: str, folder: Path, done: set[str]) -> Markup | None:
    """Tables 5.1 to 5.3; None where none of their runs is finished."""
    printed = WARM_UP if part == "table-5.1" else QUALIFYING
    key = "table-5.1" if part == "table-5.1" else "table-5.2"
    results = {name: _tasks(folder / f"{key}-{name}") for name in ("printed", "tuned") if f"{key}-{name}" in done}
    if not results:
        return None
    head = ["task", "printed", *(_NAMES[name] for name in results)]
    shares = [
        [env, f"{share:.1%}", *(_share(one.get(env)) for one in results.values())]
        for env, share in printed.success.items()
    ]
    points = [
        [env, f"{value:g}", *(_points(one.get(env)) for one in results.values())]
        for env, value in printed.penalty.items()
    ]
    return section(
        part,
        printed.caption,
        table("Success", head, shares),
        table("Penalty points of 1000 episodes", ["penalty points of 1000 episodes", *head[1:]], points),
        paragraphs(_WHY_TASKS, class_="note"),
    )


_NAMES = {"printed": "text alone", "tuned": "tuned"}


def _tasks(path: Path) -> dict[str, TaskResult]:
    result = evaluation.report(path)
    return {one.env: one for one in (result.results if isinstance(result, RunResult) else (result,))}


def _share(result: TaskResult | None) -> str:
    if result is None:
        return "–"
    low, high = wilson_interval(round(result.success * result.episodes), result.episodes)
    return f"{result.success:.1%} ({low:.1%} – {high:.1%})"


def _points(result: TaskResult | None) -> str:
    return "–" if result is None else f"{result.penalty * 1000.0 / result.episodes:.4g}"


def game_section(folder: Path, done: set[str]) -> Markup | None:
    """Tables 5.4 to 5.7; None where none of their games is finished."""
    rows = []
    for part, printed in GAMES.items():
        if part not in done:
            continue
        rows.append([printed.caption, *(f"{count}" for count in printed.violations.values()),
                     f"{sum(printed.violations.values())}", f"{printed.points:g}", "–"])  # fmt: skip
        result = msgspec.json.decode((folder / part / "result.json").read_bytes(), type=MatchResult)
        rows.append(_game_row(result))
    if not rows:
        return None
    head = ["game", *COLUMNS.values(), "total", "points", "goals"]
    return section(
        "games",
        "Whole games (tables 5.4 to 5.7)",
        table("Violations in a game", head, rows),
        paragraphs(_WHY_GAMES, class_="note"),
    )


def _game_row(result: MatchResult) -> list[str]:
    """Means of a game of 45,000 steps, and the least and the most points of one."""
    scale = [45000.0 / game.steps for game in result.games]
    counts = [
        sum(game.violations[0].get(name, 0) * by for game, by in zip(result.games, scale, strict=True)) / len(scale)
        for name in COLUMNS
    ]
    points = sorted(game.penalty[0] * by for game, by in zip(result.games, scale, strict=True))
    goals = [
        sum(game.goals[k] * by for game, by in zip(result.games, scale, strict=True)) / len(scale) for k in range(2)
    ]
    mean = sum(points) / len(points)
    return [
        f"ours, {len(scale)} games", *(f"{count:.3g}" for count in counts), f"{sum(counts):.3g}",
        f"{mean:.3g} ({points[0]:.3g} – {points[-1]:.3g})", f"{goals[0]:.3g} : {goals[1]:.3g}",
    ]  # fmt: skip
