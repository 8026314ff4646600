"""The course of a game: the score, what happened to whom, and on whose side the puck was."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from airhockey.evaluator.runs.game_records import HOME, Event, Side
from airhockey.reporting import words
from airhockey.reporting.draw.axes import Scale, picture, round_step, text
from airhockey.reporting.markup import Markup, element, number

WIDTH = 1040.0
_LEFT, _RIGHT = 76.0, WIDTH - 12.0
_SCORE_TOP, _SCORE_BOTTOM = 6.0, 92.0
_LANES: dict[Side, float] = {"home": 116.0, "away": 142.0}
_SIDE_TOP, _SIDE_BOTTOM = 162.0, 202.0
_HEIGHT = 234.0
_SHAPES = {
    "goal": "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0z",
    "point": "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0z",
    "fault": "M0-6L5.5 4H-5.5z",
    "violation": "M0-6L6 0L0 6L-6 0z",
    "forfeit": "M-5-5h10v10h-10z",
}
SHOWN = tuple(_SHAPES)


def timeline(
    events: Sequence[Event], steps: int, classes: dict[Side, str], at_home: NDArray[np.float64] | None, title: str
) -> Markup:
    """A game from its first step to its last.

    Args:
        events: All events of the game.
        steps: Control steps that it lasted.
        classes: Home's and away's colours.
        at_home: Share of the time that the puck was on home's side, in equally long parts; None where nobody knows.
        title: What is read out instead of the drawing.
    """
    x = Scale(0.0, float(max(steps, 1)))
    parts = [*_time_axis(x), *_score(events, steps, x, classes), *_lanes(events, x, classes)]
    if at_home is not None:
        parts += _side(at_home, classes)
    return picture(WIDTH, _HEIGHT, title, *parts)


def _at(x: Scale, step: float) -> float:
    return _LEFT + x(step) * (_RIGHT - _LEFT)


def _time_axis(x: Scale) -> list[Markup]:
    seconds = x.high * 0.02
    every = round_step(seconds / 8.0) if seconds < 120.0 else 60.0 * max(1.0, round_step(seconds / 60.0 / 10.0))
    parts = []
    for k in range(math.floor(seconds / every + 1e-9) + 1):
        at = _at(x, k * every / 0.02)
        parts.append(element("line", class_="grid", x1=at, x2=at, y1=_SCORE_TOP, y2=_SIDE_BOTTOM))
        label = words.clock(round(k * every / 0.02)).removesuffix(".0")
        parts.append(text(at, _HEIGHT - 16.0, label, "middle"))
    parts.append(text(_RIGHT, _HEIGHT - 2.0, "time in min:s", "end", "label"))
    return parts


def _score(events: Sequence[Event], steps: int, x: Scale, classes: dict[Side, str]) -> list[Markup]:
    """Two staircases."""
    scored = [event for event in events if event.what in ("goal", "point") and event.score is not None]
    most = max([1, *(max(event.score) for event in scored if event.score is not None)])
    y = Scale(0.0, float(most))
    parts = [text(_LEFT - 8.0, (_SCORE_TOP + _SCORE_BOTTOM) / 2 + 8.0, "score", "end", "label")]
    for value in (0, most):
        at = _SCORE_BOTTOM - y(value) * (_SCORE_BOTTOM - _SCORE_TOP - 8.0)
        parts.append(element("line", class_="grid", x1=_LEFT, x2=_RIGHT, y1=at, y2=at))
        parts.append(text(_LEFT - 8.0, at + 4.0, str(value), "end"))
    for k, side in enumerate(classes):
        shift = 0.0 if k == 0 else 2.0  # so that equal scores show both lines
        path, last = [f"M{number(_LEFT)} {number(_SCORE_BOTTOM + shift)}"], 0
        for event in scored:
            assert event.score is not None
            if event.score[k] != last:
                last = event.score[k]
                level = _SCORE_BOTTOM - y(last) * (_SCORE_BOTTOM - _SCORE_TOP - 8.0) + shift
                path.append(f"H{number(_at(x, event.step))}V{number(level)}")
        path.append(f"H{number(_at(x, steps))}")
        parts.append(element("path", class_=f"line {classes[side]}", d="".join(path)))
    return parts


def _lanes(events: Sequence[Event], x: Scale, classes: dict[Side, str]) -> list[Markup]:
    """A lane per player with what happened to it."""
    parts = []
    for side, y in _LANES.items():
        parts.append(text(_LEFT - 8.0, y + 4.0, side, "end", "label"))
        parts.append(element("line", class_="grid", x1=_LEFT, x2=_RIGHT, y1=y, y2=y))
        for event in events:
            if event.who != side or event.what not in _SHAPES:
                continue
            says = " ".join(filter(None, (words.clock(event.step), event.what, f"({event.why})" if event.why else "")))
            place = f"translate({number(_at(x, event.step))} {number(y)})"
            mark = "" if event.what in ("goal", "point") else " open"
            parts.append(
                element(
                    "path",
                    element("title", says),
                    class_=f"{classes[side]}{mark}",
                    d=_SHAPES[event.what],
                    transform=place,
                )
            )
    return parts


def _side(at_home: NDArray[np.float64], classes: dict[Side, str]) -> list[Markup]:
    """An area: home's share from below, away's from above."""
    width, height = (_RIGHT - _LEFT) / len(at_home), _SIDE_BOTTOM - _SIDE_TOP
    path = [f"M{number(_LEFT)} {number(_SIDE_BOTTOM)}"]
    for k, share in enumerate(at_home):
        level = _SIDE_BOTTOM - float(share) * height
        path.append(f"V{number(level)}H{number(_LEFT + (k + 1) * width)}")
    area = "".join(path) + f"V{number(_SIDE_BOTTOM)}z"
    box = {"x": _LEFT, "y": _SIDE_TOP, "width": _RIGHT - _LEFT, "height": height}
    others = next(side for side in classes if side != HOME)
    return [
        text(_LEFT - 8.0, (_SIDE_TOP + _SIDE_BOTTOM) / 2 + 4.0, "puck's side", "end", "label"),
        element("rect", class_=f"{classes[others]} pale", **box),
        element("path", class_="ground", d=area),
        element("path", class_=f"{classes[HOME]} pale", d=area),
    ]
