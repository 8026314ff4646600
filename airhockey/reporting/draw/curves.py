"""Curves over a common axis, with a band where a curve is the mean of several runs."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from airhockey.reporting.draw.axes import Plot, Scale
from airhockey.reporting.markup import Markup, element, number

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Curve:
    """One line.

    Attributes:
        name: What it is.
        values: At 1, 2, … of the axis; of several runs in rows, whose mean is drawn in the band of all. Shape (n,) or (r, n).
        class_: Its colour: a class of the style sheet.
    """

    name: str
    values: Array
    class_: str


def curves(lines: Sequence[Curve], x_label: str, y_label: str, title: str) -> Markup:
    """The curves in one plot; `title` is what is read out instead of it."""
    rows = [np.atleast_2d(line.values) for line in lines]
    low, high = min(float(row.min()) for row in rows), max(float(row.max()) for row in rows)
    room = 0.05 * (high - low) or max(abs(high), 1.0) * 0.05
    longest = max(row.shape[1] for row in rows)
    plot = Plot(Scale(1.0, float(max(longest, 2))), Scale(low - room, high + room), x_label, y_label)
    for line, row in zip(lines, rows, strict=True):
        if len(row) > 1:
            there, back = _path(plot, row.max(axis=0)), _path(plot, row.min(axis=0), backwards=True)
            plot.add(element("path", class_=f"{line.class_} pale", d=f"M{there}L{back}z"))
        plot.add(element("path", class_=f"{line.class_} line", d=f"M{_path(plot, row.mean(axis=0))}"))
    return plot.svg(title)


def _path(plot: Plot, values: Array, backwards: bool = False) -> str:
    points = [f"{number(plot.at_x(k))} {number(plot.at_y(float(value)))}" for k, value in enumerate(values, start=1)]
    return "L".join(reversed(points) if backwards else points)
