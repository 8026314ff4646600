"""What a game's film shows: who had the puck where, who hit it, and what became of the shots.

A *shot* is a hit after which the puck crosses the middle line away from the player, before anybody touches it again. It is *on
target* if its path at the crossing, mirrored at the side rims, ends in the goal. It is a *goal* if it scores, off the opponent
or not, before the player touches it again; *saved* if it was on target and the opponent touched it; else *off target*.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.specs import PUCK, TABLE
from airhockey.evaluator.analysis.contacts import contacts, last_of_each
from airhockey.evaluator.runs.game_records import AWAY, HOME, GameRecord, Side
from airhockey.evaluator.runs.game_trajectories import read_film

Array = NDArray[np.float64]
Outcome = Literal["goal", "saved", "off target"]
OUTCOMES: tuple[Outcome, ...] = ("goal", "saved", "off target")
_ROW = 23  # entries of a robot's half of a base observation ...
_OTHER = slice(20, 22)  # ... and where the other robot's rod tip stands in it
_TOUCHES = 50  # hits after a shot that are looked through for the shooter's own


@dataclass(frozen=True)
class Shot:
    """A shot, in world coordinates.

    Attributes:
        side: Whose.
        step: Of the hit, from 1.
        start: Where the puck was right after the hit, in [m].
        velocity: Its velocity there, in [m/s].
        outcome: See the module.
    """

    side: Side
    step: int
    start: tuple[float, float]
    velocity: tuple[float, float]
    outcome: Outcome

    @property
    def speed(self) -> float:
        """In [m/s]."""
        return float(np.hypot(*self.velocity))


@dataclass(frozen=True)
class FilmData:
    """A film, aggregated.

    Attributes:
        at_home: Share of the time that the puck was on home's side, in each of equally long parts. Shape (parts,).
        possession: The same over the whole game.
        touches: Numbers of hits of home and away.
        shots: In the order of the game.
        puck: Where the puck was, world coordinates in [m], every fifth step. Shape (n, 2).
    """

    at_home: Array
    possession: float
    touches: tuple[int, int]
    shots: tuple[Shot, ...]
    puck: Array


def read_game(path: Path, record: GameRecord, parts: int = 180) -> FilmData:
    """Analyse the film of a game.

    Raises:
        OSError, KeyError: The file is broken.
    """
    rows = read_film(path).astype(np.float64)
    serves = [event.step for event in record.events if event.what == "serve"]
    goals = {event.step: event.who for event in record.events if event.what == "goal"}
    is_first = np.zeros(len(rows), dtype=bool)
    is_first[[step for step in serves if step < len(rows)]] = True
    hits = _hits(rows, is_first)
    home = rows[:, 0] < 0.0
    edges = np.linspace(0, len(rows), min(parts, len(rows)) + 1).astype(int)[:-1]
    return FilmData(
        at_home=np.add.reduceat(home.astype(float), edges) / np.diff(np.append(edges, len(rows))),
        possession=float(home.mean()),
        touches=(sum(side == HOME for _, side in hits), sum(side == AWAY for _, side in hits)),
        shots=tuple(_shots(rows, hits, is_first, goals)),
        puck=rows[::5, :2],
    )


def _hits(rows: Array, is_first: NDArray[np.bool_]) -> list[tuple[int, Side]]:
    """The last step of every hit, and whose it was, in the order of time."""
    found: list[tuple[int, Side]] = []
    first = np.flatnonzero(is_first)
    for side, row in ((HOME, slice(_ROW, 2 * _ROW)), (AWAY, slice(0, _ROW))):  # the other one's row holds the tip
        mallet = rows[:, row][:, _OTHER]
        before, mallet_before = np.roll(rows[:, :6], 1, axis=0), np.roll(mallet, 1, axis=0)
        before[first], mallet_before[first] = rows[first, :6], mallet[first]  # a serve is no hit
        touching = contacts(before, rows[:, :6], mallet_before, mallet)
        found += [(int(step), side) for step in last_of_each(touching, is_first)]
    return sorted(found)


def _shots(
    rows: Array, hits: Sequence[tuple[int, Side]], is_first: NDArray[np.bool_], goals: dict[int, Side | None]
) -> list[Shot]:
    ends = np.append(np.flatnonzero(is_first), len(rows))
    shots = []
    for number, (step, side) in enumerate(hits):
        end_of_serve = int(ends[np.searchsorted(ends, step, side="right")])
        later = [(then, who) for then, who in hits[number + 1 : number + 1 + _TOUCHES] if then < end_of_serve]
        until = later[0][0] if later else end_of_serve
        towards = 1.0 if side == HOME else -1.0
        beyond = np.flatnonzero(rows[step:until, 0] * towards > 0.0)
        if beyond.size == 0 or rows[step, 0] * towards > 0.0:
            continue
        scored = goals.get(end_of_serve) == side and all(who != side for _, who in later)
        opponent_touched = bool(later) and later[0][1] != side
        outcome = _outcome(scored, opponent_touched, rows[step + beyond[0]], towards)
        x, y, _, speed_x, speed_y = rows[step, :5]
        shots.append(Shot(side, step + 1, (float(x), float(y)), (float(speed_x), float(speed_y)), outcome))
    return shots


def _outcome(scored: bool, opponent_touched: bool, crossing: Array, towards: float) -> Outcome:
    if scored:
        return "goal"
    return "saved" if opponent_touched and on_target(crossing, towards) else "off target"


def on_target(puck: Array, towards: float) -> bool:
    """Whether the puck's straight path, mirrored at the side rims, ends in a goal.

    Args:
        puck: x, y, yaw, ẋ, ẏ, … in world coordinates.
        towards: 1 for the goal at the right end, -1 for the left one.
    """
    x, y, _, speed_x, speed_y = puck[:5]
    if speed_x * towards <= 0.0:
        return False
    half = TABLE.width / 2 - PUCK.radius
    y = y + speed_y / speed_x * (towards * TABLE.length / 2 - x)
    folded = (y + half) % (4.0 * half)  # mirrored at both rims, it repeats after two widths
    return bool(abs((folded if folded <= 2.0 * half else 4.0 * half - folded) - half) <= TABLE.goal_width / 2)
