"""One task of one run: where it succeeds, how the puck flies, how long thinking takes, and what became of the constraints."""

import math
from collections.abc import Sequence

import numpy as np

from airhockey.envs.specs import CONTROL_PERIOD
from airhockey.evaluator.judging.tasks import wilson_interval
from airhockey.reporting import words
from airhockey.reporting.blocks import figure, figures, paragraphs, section, table
from airhockey.reporting.draw.distribution import Axes, Series, histogram, log_edges, round_edges, rows_of
from airhockey.reporting.draw.table_map import SHADES, Cell, cells, crosses, table_map
from airhockey.reporting.episodes import TaskData
from airhockey.reporting.markup import Markup, element, joined
from airhockey.reporting.results import Task
from airhockey.reporting.sections.constraints import constraints_block

TIME_LIMIT = CONTROL_PERIOD
"""How long draw_action may take, in [s]."""
_MOST_CROSSES = 40  # more of them would hide the cells, which say the same
_PER_CELL = 8  # episodes that a cell of the start map should hold


def task_section(task: Task, identifier: str) -> Markup:
    """Everything about one task."""
    heading = f"{task.env}: {task.label}"
    data = task.data
    if data is None:
        lost = "The trajectories are not there, so there is nothing to draw: the summary is all that the records tell."
        return section(identifier, heading, paragraphs([lost], "note"), _failures(task))
    return section(
        identifier,
        heading,
        figures(_starts(task, data), _hits(data), _times(data)),
        constraints_block(data),
        _failures(task),
    )


def _starts(task: Task, data: TaskData) -> Markup:
    """Success by the puck's starting position."""
    where, success = data.start[:, :2], data.success
    found, rows = _start_cells(where, success)
    failed = where[~success]
    title = (
        f"Success by starting position: {words.percent(float(success.mean()))} of {len(success)} episodes; "
        f"{len(failed)} starts without success."
    )
    layers, legend = [cells(found)], [("s10", "all succeed"), ("s5", "half"), ("s0", "none")]
    if 0 < len(failed) <= _MOST_CROSSES:
        layers.append(crosses(failed, "cross"))
        legend.append(("cross", "one without success"))
    head = ("x from", "to", "y from", "to", "episodes", "success")
    return figure(
        "Success by the puck's start",
        table_map(title, *layers, left="← robot"),
        legend=legend,
        data=table("Episodes and success by cell of the table, in m", head, rows, numbers_from=0),
    )


def _start_cells(where: np.ndarray, success: np.ndarray) -> tuple[list[Cell], list[list[str]]]:
    """Square cells over the region of the starts, as small as leaves each some episodes."""
    low, high = where.min(axis=0), where.max(axis=0)
    area = float(np.prod(np.maximum(high - low, 0.02)))
    size = min(max(math.sqrt(area * _PER_CELL / len(where)), 0.04), 0.2)
    columns, rows = (max(1, math.ceil(extent / size)) for extent in high - low + 1e-9)
    x_edges, y_edges = (
        low[0] + size * np.arange(columns + 1),
        (low[1] + high[1]) / 2 + size * (np.arange(rows + 1) - rows / 2),
    )
    bins = (x_edges, y_edges)
    played, _, _ = np.histogram2d(where[:, 0], where[:, 1], bins=bins)
    won, _, _ = np.histogram2d(where[success, 0], where[success, 1], bins=bins)
    found, listed = [], []
    for i, j in np.argwhere(played > 0):
        count, wins = int(played[i, j]), int(won[i, j])
        x, y = (f"{edges[k]:.2f} … {edges[k + 1]:.2f}" for edges, k in ((x_edges, i), (y_edges, j)))
        says = f"{wins} of {count} succeed at x {x}, y {y} m"
        shade = f"s{round(SHADES * wins / count)}"
        found.append(Cell(float(x_edges[i]), float(y_edges[j]), size, size, shade, says))
        ends = (x_edges[i], x_edges[i + 1], y_edges[j], y_edges[j + 1])
        listed.append([*(f"{end:.2f}".replace("-", "−") for end in ends), str(count), words.percent(wins / count)])
    return found, listed


def _hits(data: TaskData) -> Markup:
    """The puck's speed after each hit."""
    speed, success = data.hit_speed, data.hit_success
    if speed.size == 0:
        return figure("Puck speed after hits", element("p", "No mallet touched the puck.", class_="note"))
    edges = round_edges(0.0, float(speed.max()), 40)
    won, lost = (np.histogram(speed[chosen], edges)[0] for chosen in (success, ~success))
    per_episode = speed.size / len(data.success)
    middle = float(np.median(speed))
    rows = rows_of(edges, won, lost, form=".2f")
    title = f"Puck speed after {speed.size} hits: median {middle:.2f} m/s, highest {speed.max():.2f} m/s."
    return figure(
        "Puck speed after hits",
        histogram(
            edges,
            [Series("success", won, "good"), Series("no success", lost, "bad")],
            Axes("m/s", f"hits ({speed.size:,}, {per_episode:.2f} per episode)"),
            title,
            rules=[(middle, f"median {middle:.2f}")],
        ),
        legend=[("good", "in episodes that succeed"), ("bad", "in others")],
        data=table("Hits by speed", ("m/s", "success", "no success"), rows),
    )


def _times(data: TaskData) -> Markup:
    """Computation time of draw_action."""
    milliseconds = np.maximum(data.times, 1e-7) * 1e3
    edges = log_edges(float(milliseconds.min()), max(float(milliseconds.max()), 1e3 * TIME_LIMIT))
    late = int((data.times > TIME_LIMIT).sum())
    counts = np.histogram(milliseconds, edges)[0]
    within, beyond = counts.copy(), counts.copy()
    within[edges[1:] > 1e3 * TIME_LIMIT * (1 + 1e-9)] = 0
    beyond -= within
    rows = rows_of(edges, counts)
    mean = f"mean {milliseconds.mean():.2f} ms"
    title = f"Time of draw_action in {len(data.times)} steps: {mean}; {late} of them above 20 ms."
    return figure(
        f"Time of draw_action: {'no step' if not late else words.count(late, 'step')} above 20 ms",
        histogram(
            edges,
            [Series("in time", within, "a"), Series("too late", beyond, "bad")],
            Axes("ms", "steps", log_x=True, log_y=True),
            title,
            rules=[(1e3 * TIME_LIMIT, "20 ms")],
        ),
        data=table("Steps by time of draw_action", ("ms", "steps"), rows),
    )


def _failures(task: Task) -> Markup | None:
    """Why the agent failed episodes."""
    counts: dict[str, int] = {}
    for record in task.records:
        if record.error is not None:
            reason = record.error.partition(": ")[2] if record.error.startswith("step ") else record.error
            counts[reason] = counts.get(reason, 0) + 1
    if not counts:
        return None
    rows: Sequence[tuple[str, str]] = [
        (reason, str(number)) for reason, number in sorted(counts.items(), key=lambda item: -item[1])[:20]
    ]
    low, high = wilson_interval(task.verdict.failures, task.verdict.episodes)
    said = f"The agent failed {words.count(task.verdict.failures, 'episode')} ({low:.1%} – {high:.1%})."
    return joined(
        element("h3", "Failures of the agent"),
        paragraphs([said]),
        table("Reasons, the most frequent first", ("reason", "episodes"), rows, prose=True),
    )
