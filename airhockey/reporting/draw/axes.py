"""Scales and axes: a plot area of user units that a page scales to its column."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from airhockey.reporting.markup import Child, Markup, element, number

WIDTH = 360.0  # about the width of a phone: text keeps its size there
_MARGIN = 8.0
_LETTER = 6.2  # width of a digit of the tick labels


@dataclass(frozen=True)
class Scale:
    """Maps values to 0 … 1; values beyond its ends are drawn at its ends.

    Attributes:
        low, high: Its ends; both positive where `log`.
        log: Whether it is logarithmic.
    """

    low: float
    high: float
    log: bool = False

    def __call__(self, value: float) -> float:
        """Where a value lies."""
        value = min(max(value, self.low), self.high)
        if self.log:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def ticks(self, most: int = 6) -> list[float]:
        """Round values to label."""
        if self.log:
            decades = range(math.ceil(math.log10(self.low) - 1e-9), math.floor(math.log10(self.high) + 1e-9) + 1)
            every = max(1, math.ceil(len(decades) / most))
            return [10.0**k for k in decades if k % every == 0]
        step = round_step((self.high - self.low) / most)
        first, last = math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9)
        return [k * step for k in range(first, last + 1)]


def round_step(least: float) -> float:
    """The smallest of 1, 2, 5 × a power of ten that is not below a positive number."""
    power = 10.0 ** math.floor(math.log10(least))
    return next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= least * (1 - 1e-9))


def tick_label(value: float) -> str:
    """A tick's value, short."""
    if value != 0.0 and (abs(value) >= 1e5 or abs(value) < 1e-4):
        return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e").replace("-", "−")
    return f"{value:,.6g}".replace("-", "−")


@dataclass
class Plot:
    """A rectangle with an axis below and one on the left, and what is drawn in it.

    Attributes:
        x, y: Their scales.
        x_label, y_label: What they measure, with the unit; the latter stands above its axis.
        height: Of the whole, in user units.
        y_ticks: Values to label; round ones if not given.
    """

    x: Scale
    y: Scale
    x_label: str
    y_label: str
    height: float = 220.0
    width: float = WIDTH
    y_ticks: Sequence[float] | None = None
    content: list[Markup] = field(default_factory=list)

    def __post_init__(self) -> None:
        if self.y_ticks is None:
            self.y_ticks = self.y.ticks(5)
        longest = max((len(tick_label(tick)) for tick in self.y_ticks), default=1)
        self.left, self.right = longest * _LETTER + 10.0, self.width - 2 * _MARGIN
        self.top, self.bottom = 26.0, self.height - 36.0

    def at_x(self, value: float) -> float:
        """The user coordinate of a value on the x axis."""
        return self.left + self.x(value) * (self.right - self.left)

    def at_y(self, value: float) -> float:
        """The user coordinate of a value on the y axis."""
        return self.bottom - self.y(value) * (self.bottom - self.top)

    def add(self, *parts: Markup) -> None:
        """Draw something."""
        self.content += parts

    def rule(self, value: float, label: str, class_: str = "limit") -> None:
        """A labelled vertical line; the label stands on the side that has more room."""
        x = self.at_x(value)
        right_half = x > (self.left + self.right) / 2
        self.add(
            element("line", class_=class_, x1=x, x2=x, y1=self.top - 4.0, y2=self.bottom),
            text(x - 4.0 if right_half else x + 4.0, self.top + 5.0, label, "end" if right_half else "start", class_),
        )

    def svg(self, title: str) -> Markup:
        """The drawing; `title` is what is read out instead of it."""
        return picture(self.width, self.height, title, self._axes(), self.content)

    def _axes(self) -> list[Markup]:
        parts = [element("path", class_="axis", d=f"M{number(self.left)} {number(self.bottom)}H{number(self.right)}")]
        for tick in self.x.ticks():
            parts.append(text(self.at_x(tick), self.bottom + 14.0, tick_label(tick), "middle"))
        for tick in self.y_ticks or ():
            y = self.at_y(tick)
            parts.append(element("line", class_="grid", x1=self.left, x2=self.right, y1=y, y2=y))
            parts.append(text(self.left - 5.0, y + 3.5, tick_label(tick), "end"))
        parts.append(text(self.right, self.height - 6.0, self.x_label, "end", "label"))
        parts.append(text(2.0, 11.0, self.y_label, "start", "label"))
        return parts


def text(x: float, y: float, content: str, anchor: str = "start", class_: str | None = None) -> Markup:
    """A piece of text; `anchor` is start, middle or end."""
    return element("text", content, x=x, y=y, text_anchor=None if anchor == "start" else anchor, class_=class_)


def picture(width: float, height: float, title: str, *content: Child) -> Markup:
    """An SVG image of so many user units; `title` is what is read out instead of it."""
    box = f"0 0 {number(width)} {number(height)}"
    return element("svg", content, viewBox=box, role="img", aria_label=title, style=f"--w:{number(width)}")
