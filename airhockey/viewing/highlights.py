"""Which parts of a recording are worth a film: a few seconds around what happened."""

from collections.abc import Iterable

from airhockey.envs.specs import CONTROL_PERIOD
from airhockey.viewing.recording import Moment

KINDS = frozenset({"goal", "save", "fault", "point", "violation", "prepared", "forfeit"})
BEFORE, AFTER = 2.0, 1.0
"""Shown before and after a moment, in [s]."""
MOST_SAVES = 12
"""Of the saves of a game only those of the hardest shots are shown: good players save every few seconds."""
Span = tuple[int, int]
"""First and last control step of a part, both shown."""


def highlight_spans(
    moments: Iterable[Moment], steps: int, first: int = 0, before: float = BEFORE, after: float = AFTER
) -> list[Span]:
    """The parts around what is worth seeing; parts that touch become one.

    Args:
        moments: What happened.
        steps: Of the whole recording.
        first: First step that can be shown.
        before, after: In [s].
    """
    spans: list[Span] = []
    ahead, behind = round(before / CONTROL_PERIOD), round(after / CONTROL_PERIOD)
    for step in sorted(moment.step for moment in worth_seeing(moments)):
        begin, end = max(step - ahead, first), min(step + behind, steps)
        if spans and begin <= spans[-1][1] + 1:
            spans[-1] = spans[-1][0], max(end, spans[-1][1])
        else:
            spans.append((begin, end))
    return spans


def worth_seeing(moments: Iterable[Moment]) -> list[Moment]:
    """Everything of the `KINDS`, but of the saves only so many."""
    seen = [moment for moment in moments if moment.what in KINDS]
    hardest = sorted((moment for moment in seen if moment.what == "save"), key=lambda moment: -moment.speed)
    return [moment for moment in seen if moment.what != "save"] + hardest[:MOST_SAVES]


def frame_steps(spans: Iterable[Span], fps: float, speed: float) -> list[int]:
    """The control step that each frame of a film shows.

    A span from step a to step b lasts b - a control periods; a film of it at `speed` has as many frames as fit.

    Args:
        spans: What to show.
        fps: Frames per second of the film.
        speed: Times as fast as it was.
    """
    steps = []
    for begin, end in spans:
        per_frame = speed / (fps * CONTROL_PERIOD)
        frames = max(1, round((end - begin) / per_frame))
        steps += [min(end, begin + round((k + 1) * per_frame)) for k in range(frames)]
    return steps
