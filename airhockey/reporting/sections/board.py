"""The pages of a leaderboard: overall, per task, per entry, games."""

from collections.abc import Callable, Iterable, Mapping, Sequence

from airhockey.evaluator.judging.tasks import CLASSES, OFFICIAL_EPISODES, wilson_interval
from airhockey.reporting import words
from airhockey.reporting.blocks import Row, badge, figure, figures, paragraphs, section, table
from airhockey.reporting.draw.axes import Scale
from airhockey.reporting.draw.intervals import Interval, interval_plot
from airhockey.reporting.entries import Board, Overall, counting, in_order
from airhockey.reporting.markup import Child, Markup, element, joined
from airhockey.reporting.page import link
from airhockey.reporting.results import Task

Links = Callable[[Task], Child]
"""Gives the links of a run: its report and its videos."""
_LATEST = 30  # runs in a history's drawing


def overall_section(
    board: Board, phase: str, weights: Mapping[str, float], entry_link: Callable[[str], Child]
) -> Markup | None:
    """The ranking of a phase under one condition; None where nobody played any of its tasks."""
    ranked, incomplete = board.overall(weights), board.incomplete(weights)
    if not ranked and not incomplete:
        return None
    formula = " + ".join(f"{weight:g} × {env}" for env, weight in weights.items())
    head = ("#", "entry", "score", *weights, "penalty points")
    rows = [(one.deployability, _overall_row(one, weights, entry_link)) for one in ranked]
    lacking = [f"{name} has not played {words.enumeration(envs)}." for name, envs in incomplete]
    return section(
        f"{phase}-{_anchor(board)}",
        overall_title(board, phase),
        paragraphs([f"Score: {formula}, each the share of successes."], "note"),
        _groups(head, rows, f"{phase}, {board.label}"),
        paragraphs(lacking, "note"),
    )


def overall_title(board: Board, phase: str) -> str:
    """The heading of a ranking."""
    robot = {"phase-1": "3-DoF robot", "phase-2": "7-DoF robot"}.get(phase, phase)
    return f"Overall, {robot}, disturbances {board.label}"


def task_section(board: Board, env: str, entry_link: Callable[[str], Child], links: Links) -> Markup:
    """The ranking of one task under one condition."""
    ranked = board.ranked(env)
    head = (
        "#",
        "entry",
        "success",
        "95 % interval",
        "episodes",
        "penalty points",
        "mean time",
        "longest",
        "begun",
        "see",
    )
    rows = [(task.verdict.official_class, _task_row(entry_link(name), task, links)) for name, task in ranked]
    plot = [_interval_row(name, task) for name, task in sorted(ranked, key=lambda one: -one[1].verdict.success)]
    return section(
        f"{env}-{_anchor(board)}",
        f"Disturbances {board.label}",
        _groups(head, rows, f"{env}, {board.label}"),
        figures(figure("Success with 95 % intervals", _plot(plot, f"Success in {env}"))),
    )


def history_section(board: Board, name: str, links: Links) -> Markup | None:
    """All runs of an entry under one condition, task by task; None where it has none."""
    by_env = board.results.get(name)
    if not by_env:
        return None
    drawings, rows = [], []
    for env in in_order(by_env):
        plot = [_interval_row(_when(task), task) for task in by_env[env][-_LATEST:]]
        drawings.append(figure(f"{env}, the latest run last", _plot(plot, f"Success of {name} in {env}")))
        counts = counting(by_env[env])
        rows += [_history_row(task, links, task is counts) for task in reversed(by_env[env])]
    head = (
        "task",
        "begun",
        "success",
        "95 % interval",
        "episodes",
        "penalty points",
        "deployability",
        "airhockey",
        "",
        "see",
    )
    return section(
        f"history-{_anchor(board)}",
        f"Disturbances {board.label}",
        figures(*drawings),
        table(f"Runs of {name}", head, rows, numbers_from=2),
    )


def see(links: Iterable[tuple[str, str]]) -> Markup:
    """Links beside each other."""
    return joined(element("span", link(target, name), " ") for target, name in links)


def _groups(head: Row, rows: Sequence[tuple[str, list[Child]]], what: str) -> Markup:
    """A table for each class of deployability; ranks go on from one to the next."""
    parts: list[Markup] = []
    rank = 0
    for group in CLASSES:
        members = [row for deployability, row in rows if deployability == group]
        if not members:
            continue
        ranked = [[str(rank + k), *row] for k, row in enumerate(members, start=1)]
        rank += len(members)
        parts += [element("h3", badge(group)), table(f"{group}: {what}", head, ranked, numbers_from=2)]
    return joined(parts)


def _overall_row(one: Overall, weights: Mapping[str, float], entry_link: Callable[[str], Child]) -> list[Child]:
    shares = [f"{words.percent(one.tasks[env].verdict.success)}{_star(one.tasks[env])}" for env in weights]
    return [entry_link(one.name), element("strong", f"{one.score:.3f}"), *shares, f"{one.penalty:g}"]


def _task_row(entry: Child, task: Task, links: Links) -> list[Child]:
    mean, _, longest = task.computation_time
    return [
        entry,
        element("strong", words.percent(task.verdict.success)),
        words.interval(task.verdict.successes, task.verdict.episodes),
        _episodes(task),
        f"{task.verdict.penalty:g}",
        words.milliseconds(mean),
        words.milliseconds(longest),
        task.run.created[:10],
        links(task),
    ]


def _history_row(task: Task, links: Links, counts: bool) -> list[Child]:
    return [
        task.env,
        _when(task),
        words.percent(task.verdict.success),
        words.interval(task.verdict.successes, task.verdict.episodes),
        _episodes(task),
        f"{task.verdict.penalty:g}",
        badge(task.verdict.official_class),
        task.run.versions.get("airhockey", "–"),
        "counts" if counts else "",
        links(task),
    ]


def _when(task: Task) -> str:
    return task.run.created[:16].replace("T", " ") or "unknown"


def _interval_row(label: str, task: Task) -> Interval:
    low, high = wilson_interval(task.verdict.successes, task.verdict.episodes)
    return Interval(label, words.percent(task.verdict.success), 100 * low, 100 * task.verdict.success, 100 * high)


def _plot(rows: Sequence[Interval], what: str) -> Markup:
    title = f"{what}: " + "; ".join(f"{row.label} {row.value}" for row in rows)
    return interval_plot(rows, Scale(0.0, 100.0), "% of episodes", title)


def _episodes(task: Task) -> str:
    return f"{task.verdict.episodes:,}{_star(task)}"


def _star(task: Task) -> str:
    """Marks runs that are shorter than an official evaluation; the foot of every page explains it."""
    return "*" if task.verdict.episodes < OFFICIAL_EPISODES else ""


def _anchor(board: Board) -> str:
    return "".join(letter if letter.isalnum() else "-" for letter in board.label)
