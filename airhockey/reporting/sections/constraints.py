"""Where, when and by how much a run violated constraints, and how near it came to the others' limits."""

import numpy as np

from airhockey.envs.specs import CONTROL_PERIOD, TABLE
from airhockey.reporting import words
from airhockey.reporting.blocks import details, figure, figures, paragraphs, table
from airhockey.reporting.draw.distribution import Axes, Series, histogram, round_edges, rows_of
from airhockey.reporting.draw.table_map import cells, density_cells, points, table_map
from airhockey.reporting.episodes import Margins, TaskData
from airhockey.reporting.markup import Markup, element, joined

_MOST_DOTS = 500


def constraints_block(data: TaskData) -> Markup:
    """Violations, then every constraint's margin."""
    return joined(
        element("h3", "Constraints"),
        _violations(data),
        figures(*(_margins(name, margins) for name, margins in data.margins.items())),
        details("Every component of every constraint", _components(data)),
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
    rows = rows_of(edges, counts)
    return figure(
        f"{words.constraint(name).capitalize()}: {says}",
        histogram(
            edges,
            [Series("kept", kept, "a"), Series("violated", violated, "bad")],
            Axes(f"{unit} beyond the limit (negative: room left)", "steps", log_y=True, include=0.0),
            f"Margin of {words.constraint(name)} against its limit in {len(values)} steps: {says}.",
            rules=[(0.0, "limit")],
        ),
        data=table(f"Steps by value of {name}", (unit or "value", "steps"), rows),
    )


def _violations(data: TaskData) -> Markup:
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
    few = len(place) <= _MOST_DOTS
    layer = points(place, "bad") if few else cells(density_cells(place[inside], 0.04, "steps"))
    legend = [("bad", "a step")] if few else [("d1", "few steps"), ("d5", "some"), ("d10", "many")]
    if not inside.all():
        legend.append(("none", f"{int((~inside).sum()):,} beyond the edge"))
    said = f"{words.constraint(name).capitalize()} violated: where"
    title = f"{said} the end-effector was, in {len(place)} steps."
    return figure(said, table_map(title, layer, left="← robot"), legend=legend)


def _violation_times(violated: dict[str, Margins]) -> Markup:
    """When in the episodes constraints were violated."""
    longest = max(float(margins.step.max()) for margins in violated.values()) * CONTROL_PERIOD
    edges = round_edges(0.0, longest, 30)
    colours = ("a", "b", "c", "d")
    series = [
        Series(name, np.histogram(margins.step * CONTROL_PERIOD, edges)[0], colours[k % 4])
        for k, (name, margins) in enumerate(violated.items())
    ]
    rows = rows_of(edges, *(one.counts for one in series), form=".2f")
    return figure(
        "Constraints violated: when",
        histogram(
            edges,
            series,
            Axes("s since the start", "steps"),
            "Violating steps by the time since the episode's start.",
        ),
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
            rows.append(
                (
                    f"{words.constraint(name)}, {label}",
                    *(f"{-v:.4g} {unit}".replace("-", "−") for v in (worst.max(), np.median(worst))),
                    share,
                )
            )
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
