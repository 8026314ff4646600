"""The table seen from above, in its proportions, with goals; and what happened where on it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.specs import TABLE
from airhockey.reporting.draw.axes import WIDTH, picture, text
from airhockey.reporting.markup import Markup, element, joined, number

Array = NDArray[np.float64]
SHADES = 10
"""Steps of the colour scales: classes s0 … s10 (a share) and d1 … d10 (a density) of the style sheet."""
_SIDE, _TOP = 13.0, 6.0
_SCALE = (WIDTH - 2 * _SIDE) / TABLE.length
_HEIGHT = TABLE.width * _SCALE


@dataclass(frozen=True)
class Cell:
    """A rectangle of the table, world coordinates in [m], with its colour class and what it says when pointed at."""

    x: float
    y: float
    width: float
    height: float
    class_: str
    says: str


def at(x: float, y: float) -> tuple[float, float]:
    """The drawing's coordinates of a point in world coordinates, in [m]; y points up."""
    return _SIDE + (x + TABLE.length / 2) * _SCALE, _TOP + (TABLE.width / 2 - y) * _SCALE


def table_map(title: str, *layers: Markup, left: str = "", right: str = "") -> Markup:
    """The table with layers on it.

    Args:
        title: What is read out instead of it.
        layers: From `cells`, `points` and `arrows`.
        left, right: Who plays where, written below.
    """
    labels = [text(_SIDE, _TOP + _HEIGHT + 18.0, left, class_="label")] if left else []
    if right:
        labels.append(text(WIDTH - _SIDE, _TOP + _HEIGHT + 18.0, right, "end", "label"))
    height = _TOP * 2 + _HEIGHT + (16.0 if labels else 0.0)
    return picture(WIDTH, height, title, _ground(), layers, _lines(), labels)


def cells(found: Iterable[Cell]) -> Markup:
    """Coloured rectangles."""
    return element("g", *(_cell(cell) for cell in found))


def points(where: Array, class_: str, radius: float = 2.2) -> Markup:
    """Dots. `where`: world coordinates in [m], shape (n, 2)."""
    path = []
    for x, y in where:
        u, v = at(x, y)
        path.append(f"M{number(u)} {number(v)}h0")
    return element("path", class_=f"dots {class_}", d="".join(path), stroke_width=2 * radius)


def crosses(where: Array, class_: str, size: float = 2.6) -> Markup:
    """Crosses. `where`: world coordinates in [m], shape (n, 2)."""
    double = number(2 * size)
    path = []
    for x, y in where:
        u, v = at(x, y)
        corner = f"{number(u - size)} {number(v - size)}"
        path.append(f"M{corner}l{double} {double}m-{double} 0l{double} -{double}")
    return element("path", class_=f"crosses {class_}", d="".join(path))


def arrows(starts: Array, ends: Array, class_: str, says: Sequence[str]) -> Markup:
    """Lines with a dot where they start. `starts`, `ends`: world coordinates in [m], each of shape (n, 2)."""
    drawn = []
    for start, end, words in zip(starts, ends, says, strict=True):
        (u, v), (a, b) = at(*start), at(*end)
        head = element("circle", cx=u, cy=v, r=2.0)
        line = element("line", x1=u, y1=v, x2=a, y2=b)
        drawn.append(element("g", head, line, element("title", words)))
    return element("g", *drawn, class_=f"shots {class_}")


def density_cells(where: Array, size: float, unit: str) -> list[Cell]:
    """Cells coloured by how many points fall into them, up to a shade for the fullest; empty ones are left out.

    Args:
        where: World coordinates in [m]. Shape (n, 2).
        size: Side of a cell, in [m].
        unit: What is counted, for what a cell says.
    """
    columns, rows = int(np.ceil(TABLE.length / size)), int(np.ceil(TABLE.width / size))
    extent = (
        (-TABLE.length / 2, -TABLE.length / 2 + columns * size),
        (-TABLE.width / 2, -TABLE.width / 2 + rows * size),
    )
    counts, x_edges, y_edges = np.histogram2d(where[:, 0], where[:, 1], bins=(columns, rows), range=extent)
    fullest = max(float(np.sqrt(counts.max())), 1.0)
    found = []
    for i, j in np.argwhere(counts > 0):
        count = int(counts[i, j])
        shade = max(1, round(SHADES * float(np.sqrt(count)) / fullest))  # roots: rare places stay visible
        found.append(Cell(float(x_edges[i]), float(y_edges[j]), size, size, f"d{shade}", f"{count:,} {unit}"))
    return found


def _cell(cell: Cell) -> Markup:
    """A rectangle, cut off at the rims."""
    x, y = max(cell.x, -TABLE.length / 2), max(cell.y, -TABLE.width / 2)
    u, v = at(x, min(cell.y + cell.height, TABLE.width / 2))
    width = (min(cell.x + cell.width, TABLE.length / 2) - x) * _SCALE
    height = (min(cell.y + cell.height, TABLE.width / 2) - y) * _SCALE
    shape = element("title", cell.says) if cell.says else None
    return element("rect", shape, class_=cell.class_, x=u, y=v, width=max(width, 0.0), height=max(height, 0.0))


def _ground() -> Markup:
    return element("rect", class_="ground", x=_SIDE, y=_TOP, width=TABLE.length * _SCALE, height=_HEIGHT)


def _lines() -> Markup:
    """Rims, middle line and goals."""
    middle, half_goal = WIDTH / 2, TABLE.goal_width / 2 * _SCALE
    centre = _TOP + _HEIGHT / 2
    goals = [
        element("rect", class_="goal", x=x, y=centre - half_goal, width=5.0, height=2 * half_goal)
        for x in (_SIDE - 6.0, WIDTH - _SIDE + 1.0)
    ]
    rim = element("rect", class_="rim", x=_SIDE, y=_TOP, width=TABLE.length * _SCALE, height=_HEIGHT)
    return joined(element("line", class_="middle", x1=middle, x2=middle, y1=_TOP, y2=_TOP + _HEIGHT), rim, *goals)
