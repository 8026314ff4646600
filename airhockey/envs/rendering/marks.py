"""Marks in the scene that are no part of it: a path, a trail, a target."""

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Color = tuple[float, float, float, float]

PREDICTED: Color = (0.98, 0.62, 0.10, 0.9)
TRAIL: Color = (0.85, 0.15, 0.12, 0.55)
TARGETS: tuple[Color, Color] = ((0.12, 0.42, 0.86, 0.75), (0.10, 0.60, 0.32, 0.75))
TARGET_RADIUS = 0.025
"""Of the disc where a mallet is wanted, in [m]."""
_HEIGHT = 0.006  # [m] above the table
_WIDTH = 0.006  # [m]


@dataclass(frozen=True)
class Mark:
    """A line between two points, or a flat disc where both are the same.

    Attributes:
        start, end: In the world, in [m].
        radius: Of the line or disc, in [m].
    """

    start: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float
    color: Color


def path(points: Array, color: Color, fades: bool = True, width: float = _WIDTH) -> list[Mark]:
    """Lines from point to point on the table.

    Args:
        points: x and y, in [m]. Shape (k, 2).
        color: At the first point.
        fades: Whether the last one is hardly seen.
        width: In [m].
    """
    marks = []
    for k, (a, b) in enumerate(itertools.pairwise(points)):
        if np.hypot(*(b - a)) < 1e-4:
            continue
        alpha = color[3] * (1.0 - 0.85 * k / len(points) if fades else 1.0)
        marks.append(Mark((*a, _HEIGHT), (*b, _HEIGHT), width / 2, (*color[:3], alpha)))
    return marks


def target(point: Sequence[float], player: int) -> Mark:
    """Where player 0 or 1 wants its mallet, as a disc on the table; x and y in [m]."""
    place = (float(point[0]), float(point[1]), _HEIGHT)
    return Mark(place, place, TARGET_RADIUS, TARGETS[player])


def geoms(marks: Iterable[Mark]) -> list[Any]:
    """The marks as MuJoCo draws them."""
    made = []
    for mark in marks:
        geom = mujoco.MjvGeom()
        _fill(geom, mark)
        made.append(geom)
    return made


def add_to_scene(scene: Any, marks: Iterable[Mark]) -> None:
    """Draw the marks in a scene that was just updated, as far as there is room."""
    for mark in marks:
        if scene.ngeom >= scene.maxgeom:
            return
        _fill(scene.geoms[scene.ngeom], mark)
        scene.ngeom += 1


def _fill(geom: Any, mark: Mark) -> None:
    color = np.array(mark.color, dtype=np.float32)
    disc = mark.start == mark.end
    kind = mujoco.mjtGeom.mjGEOM_CYLINDER if disc else mujoco.mjtGeom.mjGEOM_CAPSULE
    size = np.array([mark.radius, mark.radius, 0.002])
    mujoco.mjv_initGeom(geom, kind, size, np.array(mark.start), np.eye(3).ravel(), color)
    if not disc:
        mujoco.mjv_connector(geom, kind, mark.radius, np.array(mark.start), np.array(mark.end))
    geom.category, geom.emission = mujoco.mjtCatBit.mjCAT_DECOR, 0.4
