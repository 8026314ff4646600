"""What is said about a task of a run in figures, the same wherever it is said."""

from collections.abc import Sequence

from airhockey.reporting import words
from airhockey.reporting.blocks import Row, badge, table
from airhockey.reporting.markup import Child, Markup, element
from airhockey.reporting.results import Task

FEW = 3
"""Tasks that stand beside each other on an ordinary screen; more of them stand below each other."""


def quantities(task: Task, kinds: Sequence[str], short: bool = False) -> list[tuple[str, Child]]:
    """Names and values.

    Args:
        task: Of a run.
        kinds: Constraints to name.
        short: Names for the head of a column.
    """
    mean, p99, longest = task.computation_time
    violated = "" if short else " violated"
    times = (
        ("mean time", "p99", "longest") if short else ("draw_action, mean", "draw_action, p99", "draw_action, longest")
    )
    return [
        ("success", element("strong", words.percent(task.verdict.success))),
        ("95 % interval", words.interval(task.verdict.successes, task.verdict.episodes)),
        ("episodes", f"{task.verdict.episodes:,}"),
        ("penalty points", f"{task.verdict.penalty:g}"),
        ("deployability", badge(task.verdict.official_class)),
        *((f"{words.constraint(name)}{violated}", str(task.violations.get(name, "–"))) for name in kinds),
        (times[0], words.milliseconds(mean)),
        (times[1], "–" if p99 is None else words.milliseconds(p99)),
        (times[2], words.milliseconds(longest)),
        ("failed" if short else "episodes failed by the agent", str(task.verdict.failures)),
    ]


def kinds_of(tasks: Sequence[Task]) -> list[str]:
    """Constraints that any of the tasks has."""
    return list(dict.fromkeys(name for task in tasks for name in task.violations))


def side_by_side(caption: str, tasks: Sequence[Task], heads: Sequence[str]) -> Markup:
    """A table with a column per task."""
    columns = [quantities(task, kinds_of(tasks)) for task in tasks]
    rows: list[Row] = [(name, *(column[k][1] for column in columns)) for k, (name, _) in enumerate(columns[0])]
    return table(caption, ("", *heads), rows)


def one_below_another(caption: str, tasks: Sequence[Task]) -> Markup:
    """A table with a row per task."""
    kinds = kinds_of(tasks)
    head = ("task", "agent", *(name for name, _ in quantities(tasks[0], kinds, short=True)))
    rows: list[Row] = [
        (task.env, task.label, *(value for _, value in quantities(task, kinds, short=True))) for task in tasks
    ]
    return table(caption, head, rows, numbers_from=2)
