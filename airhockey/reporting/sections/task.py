"""One task of one run: where it succeeds, where constraints were violated, how the puck flies, how long thinking takes."""

import math
from collections.abc import Sequence

import numpy as np

from airhockey.envs.specs import TABLE
from airhockey.evaluator.judging import wilson_interval
from airhockey.reporting import words
from airhockey.reporting.blocks import details, figure, figures, paragraphs, section, table
from airhockey.reporting.draw.distribution import Series, histogram, log_edges, round_edges
from airhockey.reporting.draw.table_map import SHADES, Cell, cells, crosses, density_cells, points, table_map
from airhockey.reporting.episodes import Margins, TaskData
from airhockey.reporting.markup import Markup, element, joined
from airhockey.reporting.results import Task

TIME_LIMIT = 0.02
"""A control step, in [s]: how long draw_action may take."""
_MOST_MARKS = 500
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
        element("h3", "Constraints"),
        _violations(task, data),
        figures(*(_margins(name, margins) for name, margins in data.margins.items())),
        details("Every component of every constraint", _components(data)),
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
    layers = [cells(found), crosses(failed[:_MOST_MARKS], "bad")]
    head = ("x from", "to", "y from", "to", "episodes", "success")
    return figure(
        "Success by the puck's start",
        table_map(title, *layers, left="← robot"),
        legend=[("s10", "all succeed"), ("s5", "half"), ("s0", "none"), ("cross bad", "one without success")],
        data=table("Episodes and success by cell of the table, in m", head, rows, numbers_from=0),
    )


def _start_cells(where: np.ndarray, success: np.ndarray) -> tuple[list[Cell], list[list[str]]]:
    """Square cells over the region of the starts, as small as leaves each some episodes."""
    low, high = where.min(axis=0), where.max(axis=0)
    area = float(np.prod(np.maximum(high - low, 0.02)))
    size = min(max(math.sqrt(area * _PER_CELL / len(where)), 0.04), 0.2)
    columns, rows = (max(1, math.ceil(extent / size)) for extent in high - low + 1e-9)
    x_edges, y_edges = low[0] + size * np.arange(columns + 1), (low[1] + high[1]) / 2 + size * (
        np.arange(rows + 1) - rows / 2
    )
    bins = (x_edges, y_edges)
    played, _, _ = np.histogram2d(where[:, 0], where[:, 1], bins=bins)
    won, _, _ = np.histogram2d(where[success, 0], where[success, 1], bins=bins)
    found, listed = [], []
    for i, j in np.argwhere(played > 0):
        count, wins = int(played[i, j]), int(won[i, j])
        says = f"{wins} of {count} succeed at x {x_edges[i]:.2f} … {x_edges[i + 1]:.2f}, y {y_edges[j]:.2f} … {y_edges[j + 1]:.2f} m"
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
    rows = [(f"{a:.2f} – {b:.2f}", str(w), str(f)) for a, b, w, f in zip(edges, edges[1:], won, lost, strict=False)]
    title = f"Puck speed after {speed.size} hits: median {middle:.2f} m/s, highest {speed.max():.2f} m/s."
    return figure(
        "Puck speed after hits",
        histogram(
            edges,
            [Series("success", won, "good"), Series("no success", lost, "bad")],
            "m/s",
            f"hits ({speed.size:,}, {per_episode:.2f} per episode)",
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
    rows = [(f"{a:.3g} – {b:.3g}", f"{n:,}") for a, b, n in zip(edges, edges[1:], counts, strict=False) if n]
    title = f"Time of draw_action in {len(counts)} bins: mean {milliseconds.mean():.2f} ms; {late} of {len(data.times)} steps above 20 ms."
    return figure(
        f"Time of draw_action: {'no step' if not late else words.count(late, 'step')} above 20 ms",
        histogram(
            edges,
            [Series("in time", within, "a"), Series("too late", beyond, "bad")],
            "ms",
            "steps",
            title,
            log_x=True,
            log_y=True,
            rules=[(1e3 * TIME_LIMIT, "20 ms")],
        ),
        data=table("Steps by time of draw_action", ("ms", "steps"), rows),
    )


def _margins(name: str, margins: Margins) -> Markup:
    """How near a constraint came to its limit."""
    values = margins.per_step
    low, high = float(values.min()), float(values.max())
    edges = round_edges(low, max(high, 0.0), 36)
    counts = np.histogram(values, edges)[0]
    kept, violated = counts.copy(), counts.copy()
    kept[edges[:-1] >= -1e-12] = 0
    violated -= kept
    unit = words.UNITS.get(name, "")
    nearest = f"{abs(high):.3g} {unit}"
    says = f"violated by up to {nearest}" if high > 0.0 else f"at least {nearest} left"
    rows = [(f"{a:.3g} – {b:.3g}", f"{n:,}") for a, b, n in zip(edges, edges[1:], counts, strict=False) if n]
    return figure(
        f"{words.constraint(name).capitalize()}: {says}",
        histogram(
            edges,
            [Series("kept", kept, "a"), Series("violated", violated, "bad")],
            f"{unit} beyond the limit (negative: room left)",
            "steps",
            f"Margin of {words.constraint(name)} against its limit in {len(values)} steps: {says}.",
            log_y=True,
            rules=[(0.0, "limit")],
            include=-high if high > 0.0 else 0.0,
        ),
        data=table(f"Steps by value of {name}", (unit or "value", "steps"), rows),
    )


def _violations(task: Task, data: TaskData) -> Markup:
    """Where and when constraints were violated."""
    violated = {name: margins for name, margins in data.margins.items() if margins.value.size}
    if not violated:
        return element("p", f"No constraint was violated in any of {len(data.times):,} steps.", class_="lead")
    sentences = []
    for name, margins in violated.items():
        episodes = int((margins.worst > 0.0).any(axis=1).sum())
        sentences.append(
            f"{words.constraint(name).capitalize()}: {words.count(margins.value.size, 'step')} in "
            f"{words.count(episodes, 'episode')}, by {np.median(margins.value):.3g} {words.UNITS.get(name, '')} in the median."
        )
    maps = [_violation_map(name, margins) for name, margins in violated.items()]
    return joined(paragraphs([" ".join(sentences)], "lead"), figures(*maps, _violation_times(violated)))


def _violation_map(name: str, margins: Margins) -> Markup:
    """Where the end-effector was when a constraint was violated."""
    place = margins.place[np.isfinite(margins.place).all(axis=1)]
    inside = (np.abs(place) < (TABLE.length / 2, TABLE.width / 2)).all(axis=1)
    few = len(place) <= _MOST_MARKS
    layer = points(place, "bad") if few else cells(density_cells(place[inside], 0.04, "steps"))
    beyond = f"; {words.count(int((~inside).sum()), 'step')} beyond the table's edge" if not inside.all() else ""
    title = f"End-effector in {len(place)} steps that violate {words.constraint(name)}{beyond}."
    return figure(
        f"{words.constraint(name).capitalize()} violated: where the end-effector was{beyond}",
        table_map(title, layer, left="← robot"),
        legend=[("bad", "a step")] if few else [("d1", "few steps"), ("d5", ""), ("d10", "many")],
    )


def _violation_times(violated: dict[str, Margins]) -> Markup:
    """When in the episodes constraints were violated."""
    longest = max(float(margins.step.max()) for margins in violated.values()) * 0.02
    edges = round_edges(0.0, longest, 30)
    colours = ("a", "b", "c", "d")
    series = [
        Series(name, np.histogram(margins.step * 0.02, edges)[0], colours[k % 4])
        for k, (name, margins) in enumerate(violated.items())
    ]
    rows = [
        (f"{a:.2f} – {b:.2f}", *(str(one.counts[k]) for one in series))
        for k, (a, b) in enumerate(zip(edges, edges[1:], strict=False))
    ]
    return figure(
        "When constraints were violated",
        histogram(edges, series, "s since the start", "steps", "Violating steps by the time since the episode's start."),
        legend=[(one.class_, words.constraint(one.name)) for one in series],
        data=table("Violating steps by time in s", ("s", *(words.constraint(one.name) for one in series)), rows),
    )


def _components(data: TaskData) -> Markup:
    """The nearest approach of every component to its limit."""
    rows = []
    for name, margins in data.margins.items():
        for k, label in enumerate(component_labels(name, margins.worst.shape[1])):
            worst = margins.worst[:, k]
            unit = words.UNITS.get(name, "")
            share = f"{int((worst > 0).sum()):,}"
            rows.append((f"{words.constraint(name)}, {label}", *(f"{-v:.4g} {unit}".replace("-", "−") for v in (worst.max(), np.median(worst))), share))
    head = ("component", "least room", "median of the episodes' least", "episodes violating")
    return table("Room left to the limit, by component", head, rows)


def component_labels(name: str, size: int) -> list[str]:
    """What the components of a constraint stand for."""
    if name.startswith("joint"):
        half = size // 2
        return [f"joint {k % half + 1} {'upper' if k < half else 'lower'}" for k in range(size)]
    known = {
        "ee_constr": ["behind", "right rim", "left rim", "too low", "too high"],
        "link_constr": ["wrist height", "elbow height"],
    }.get(name, [])
    return known if len(known) == size else [f"component {k + 1}" for k in range(size)]


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
    low, high = wilson_interval(task.failures, task.episodes)
    said = f"The agent failed {words.count(task.failures, 'episode')} ({low:.1%} – {high:.1%})."
    return joined(
        element("h3", "Failures of the agent"),
        paragraphs([said]),
        table("Reasons, the most frequent first", ("reason", "episodes"), rows, prose=True),
    )
