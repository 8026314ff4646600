"""Recordings of games, made of their films and of what the referee noted."""

import bisect
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.editions import DEFAULT
from airhockey.envs.specs import CONTROL_PERIOD, IIWA
from airhockey.errors import ConfigurationError
from airhockey.evaluator.analysis.shots import shots_of
from airhockey.evaluator.runs.game_records import SIDES, Event, GameRecord
from airhockey.viewing.caption import Caption
from airhockey.viewing.recording import Moment, Recording

Array = NDArray[np.float64]
N = IIWA.n_joints
WIDTH = 9 + 2 * N
"""Entries of one robot's row of a base observation: puck, joints, the other's tip."""
NEWS_STEPS = 125
"""How long something stays news, in control steps."""
LOOKED_AT = 300
"""Latest moments among which news is looked for; no more happen while something is news."""


@dataclass(frozen=True)
class GameNarrator:
    """Captions of a game, from its moments.

    Attributes:
        title, players: Said all the time.
        events: The referee's, in order.
        moments: The same and more, in order.
    """

    title: str
    players: tuple[str, str]
    events: Sequence[Event]
    moments: Sequence[Moment]
    _counts: list[tuple[int, tuple[int, int], tuple[int, int], tuple[float, float]]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        score, faults, penalty = (0, 0), [0, 0], [0.0, 0.0]
        counts = [(-1, score, (0, 0), (0.0, 0.0))]
        for event in self.events:
            score = event.score or score
            if event.who is not None and event.what in ("fault", "violation"):
                k = SIDES.index(event.who)
                faults[k] += event.what == "fault"
                penalty[k] += event.points
            counts.append((event.step, score, (faults[0], faults[1]), (penalty[0], penalty[1])))
        object.__setattr__(self, "_counts", counts)

    def caption(self, step: int) -> Caption:
        """See `Narrator`."""
        counted = bisect.bisect_right(self._counts, step, key=lambda count: count[0]) - 1
        _, score, faults, penalty = self._counts[counted]
        happened = bisect.bisect_right(self.moments, step, key=lambda moment: moment.step)
        recent = [
            moment
            for moment in self.moments[max(0, happened - LOOKED_AT) : happened]
            if step - moment.step < NEWS_STEPS
        ]
        violations = [moment.text for moment in recent if moment.what == "violation"]
        alarm, news = (violations[-1] if violations else ""), latest(recent)
        return Caption(self.title, self.players, step * CONTROL_PERIOD, score, faults, penalty, news=news, alarm=alarm)


def game_recording(name: str, film: Array, record: GameRecord | None) -> Recording:
    """A game's film, with what was noted about it.

    Args:
        name: The game's key.
        film: Base observations at every step's end. Shape (T, 46).
        record: The judge's; None where it is missing: then nobody knows the score.

    Raises:
        ConfigurationError: The film is empty or of another shape.
    """
    if film.ndim != 2 or film.shape[1] != 2 * WIDTH or len(film) == 0:
        raise ConfigurationError(f"game {name!r} has no film that can be shown: its shape is {film.shape}, not (T, 46)")
    players = (record.job.home, record.job.away) if record else ("home", "away")
    rows = film.reshape(-1, 2, WIDTH)
    joints = rows[:, :, 6 : 6 + N]
    events = record.events if record else ()
    moments = [moment_of(event, players) for event in events]
    for shot in shots_of(film, events):
        if shot.outcome == "saved" and shot.touched is not None:
            k = 1 - SIDES.index(shot.side)
            moments.append(Moment(shot.touched, "save", k, f"{players[k]} saves", shot.speed))
    moments.sort(key=lambda moment: moment.step)
    title = f"game {name}" if record else f"game {name} (no record: score unknown)"
    narrator = GameNarrator(title, players, events, moments)
    return Recording(
        name, f"{title}: {players[0]} - {players[1]}", "tournament",
        film[:, :3], film[:, 3:6], joints, narrator, tuple(moments), first_step=1,
        edition=record.edition if record else DEFAULT,
    )  # fmt: skip


def latest(recent: Sequence[Moment]) -> str:
    """What to say of what happened lately: the latest, but of a serve only where nothing led to it."""
    said = [moment for moment in recent if moment.what not in ("violation", "held")]
    telling = [moment for moment in said if moment.what != "serve"] or said
    return telling[-1].text if telling else ""


def moment_of(event: Event, players: Sequence[str]) -> Moment:
    """The referee's event as a moment."""
    k = None if event.who is None else SIDES.index(event.who)
    name = "" if k is None else players[k]
    texts = {
        "goal": f"goal for {name}",
        "point": f"point for {name}: three faults of the opponent",
        "fault": f"fault of {name}",
        "stuck": "the puck is stuck in the middle",
        "out": "the puck left the table",
        "serve": f"the puck is with {name}",
        "forfeit": f"{name} forfeits" if name else "both forfeit",
        "violation": f"{name} violates {(event.why or 'a constraint').partition(':')[0]}",
    }
    return Moment(event.step, event.what, k, texts.get(event.what, event.what))
