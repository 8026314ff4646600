"""Estimates with their intervals, one row each, on a common axis."""

from collections.abc import Sequence
from typing import NamedTuple

from airhockey.reporting.draw.axes import WIDTH, Scale, picture, text, tick_label
from airhockey.reporting.markup import Markup, element, number

_ROW, _TOP, _BOTTOM = 36.0, 6.0, 34.0
_LEFT, _RIGHT = 8.0, WIDTH - 14.0


class Interval(NamedTuple):
    """A row: its label, what stands at its right end, the estimate within its interval, and a colour class."""

    label: str
    value: str
    low: float
    estimate: float
    high: float
    class_: str = "a"


def interval_plot(
    rows: Sequence[Interval], scale: Scale, x_label: str, title: str, mark: float | None = None
) -> Markup:
    """The rows, their labels above them so that any name has room; `mark` is a value to draw a line at."""
    height = _TOP + _ROW * len(rows) + _BOTTOM
    bottom = height - _BOTTOM

    def at(value: float) -> float:
        return _LEFT + scale(value) * (_RIGHT - _LEFT)

    parts = []
    for tick in scale.ticks(5):
        parts.append(element("line", class_="grid", x1=at(tick), x2=at(tick), y1=_TOP, y2=bottom))
        parts.append(text(at(tick), bottom + 13.0, tick_label(tick), "middle"))
    if mark is not None:
        parts.append(element("line", class_="limit", x1=at(mark), x2=at(mark), y1=_TOP, y2=bottom))
    parts.append(text(_RIGHT, height - 5.0, x_label, "end", "label"))
    for k, row in enumerate(rows):
        y = _TOP + _ROW * k + 26.0
        bar = f"M{number(at(row.low))} {number(y)}H{number(at(row.high))}"
        parts += [
            text(_LEFT, y - 11.0, row.label if len(row.label) <= 40 else row.label[:39] + "…", class_="name"),
            text(_RIGHT, y - 11.0, row.value, "end", "name"),
            element("path", class_=f"whisker {row.class_}", d=bar),
            element("circle", class_=row.class_, cx=at(row.estimate), cy=y, r=4.5),
        ]
    return picture(WIDTH, height, title, *parts)
