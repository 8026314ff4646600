"""Distributions: stacked histograms with linear or logarithmic axes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from airhockey.reporting.draw.axes import Plot, Scale, round_step
from airhockey.reporting.markup import Markup, element, number

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Series:
    """One colour of a histogram.

    Attributes:
        name: What it counts.
        counts: Per bin.
        class_: Its colour: a class of the style sheet.
    """

    name: str
    counts: NDArray[np.int64]
    class_: str


@dataclass(frozen=True)
class Axes:
    """The axes of a histogram.

    Attributes:
        x_label, y_label: What stands beside them.
        log_x, log_y: Whether they are logarithmic.
        include: A value that the x axis reaches whatever the data are.
    """

    x_label: str
    y_label: str
    log_x: bool = False
    log_y: bool = False
    include: float | None = None


def log_edges(low: float, high: float, per_decade: int = 10) -> Array:
    """Edges of bins that are equally wide on a logarithmic axis and cover low … high (both positive)."""
    first = math.floor(math.log10(low) * per_decade + 1e-9)
    last = math.ceil(math.log10(high) * per_decade - 1e-9)
    return np.asarray(10.0 ** (np.arange(first, max(last, first + 1) + 1) / per_decade))


def round_edges(low: float, high: float, bins: int = 30) -> Array:
    """Edges of about `bins` bins of a round width that cover low … high; 0 is an edge if it lies between them."""
    width = round_step(max(high - low, 1e-9) / bins)
    first, last = math.floor(low / width + 1e-9), math.ceil(high / width - 1e-9)
    return np.asarray(np.arange(first, max(last, first + 1) + 1) * width)


def rows_of(edges: Array, *counts: NDArray[np.int64], form: str = ".3g") -> list[tuple[str, ...]]:
    """The rows of a histogram's data table: the bin, then how much is in it; empty bins are left out."""
    filled = np.flatnonzero(np.sum(counts, axis=0))
    return [
        (f"{edges[k]:{form}} – {edges[k + 1]:{form}}".replace("-", "−"), *(f"{one[k]:,}" for one in counts))
        for k in filled
    ]


def histogram(
    edges: Array, series: Sequence[Series], axes: Axes, title: str, rules: Sequence[tuple[float, str]] = ()
) -> Markup:
    """A histogram; the series are stacked (on a logarithmic count axis they stand behind each other).

    Args:
        edges: Of the bins. Shape (b + 1,).
        series: Each with counts of shape (b,).
        axes: What they say and how they are divided.
        title: What is read out instead of it.
        rules: Labelled vertical lines: a limit, a mean.
    """
    counts = [one.counts for one in series]
    total = np.max(counts, axis=0) if axes.log_y else np.sum(counts, axis=0)
    highest = float(max(total.max(), 1))
    top = 10.0 ** math.ceil(math.log10(highest * 1.2))
    y = Scale(0.5, top, log=True) if axes.log_y else Scale(0.0, _ceiling(highest))
    low, high = float(edges[0]), float(edges[-1])
    if axes.include is not None:
        low, high = min(low, axes.include), max(high, axes.include)
    plot = Plot(Scale(low, high, log=axes.log_x), y, axes.x_label, axes.y_label)
    below = np.zeros(len(edges) - 1)
    for one in series:
        base = np.zeros_like(below) if axes.log_y else below
        plot.add(_bars(plot, edges, base, base + one.counts, one))
        below = base + one.counts
    for value, label in rules:
        plot.rule(value, label)
    return plot.svg(title)


def _bars(plot: Plot, edges: Array, below: Array, above: Array, series: Series) -> Markup:
    """All bars of a series as one path, which is a tenth of as many rectangles."""
    path = []
    for k in np.flatnonzero(series.counts):
        x0, x1 = plot.at_x(edges[k]), plot.at_x(edges[k + 1])
        gap = 0.5 if x1 - x0 > 3.0 else 0.0
        y0, y1 = plot.at_y(below[k]), plot.at_y(above[k])
        path.append(f"M{number(x0 + gap)} {number(y0)}V{number(y1)}H{number(x1 - gap)}V{number(y0)}z")
    return element("path", class_=series.class_, d="".join(path))


def _ceiling(value: float) -> float:
    """A round number not below a positive one, near it."""
    step = max(round_step(value / 5.0), 1.0)
    return math.ceil(value / step - 1e-9) * step
