"""Standings of a tournament, from the records of its games alone.

3 points for a win, 1 for a draw, 0 for a loss: an entry's *points*. The score board of a game counts other ones, *points for* an
entry and *points against* it: its goals, and those that it was given *by faults* of the opponent. Ties are broken, in this order,
by: difference of the score board's points, those for, points in the games among those tied (head to head), fewer penalty
points, name.

Ratings (openskill, Plackett-Luce) are computed over the games in the order of the schedule, so that they do not depend on
the order in which the games happened to be played.
"""

import csv
import io
from collections.abc import Iterable, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import msgspec

from airhockey.envs.editions import DEFAULT
from airhockey.evaluator.runs import notebook
from airhockey.evaluator.runs.disk import disk_errors, replace_file, write_record
from airhockey.evaluator.runs.game_records import GameJob, GameRecord, in_order

WIN, DRAW = 3, 1


class Row(msgspec.Struct, frozen=True, kw_only=True):
    """One entry's standing.

    Attributes:
        points: 3 per win, 1 per draw.
        goals, conceded: Goals scored, and those of the opponents.
        by_faults: Points on the score board for the opponents' faults.
        points_for, points_against: On the score board: goals, and points by faults.
        difference: Of those two.
        penalty: Penalty points over all its games.
        forfeits: Games that it failed.
        rating, uncertainty: Mean and standard deviation of its skill (openskill; everybody starts at 25 ± 8.33).
    """

    rank: int
    name: str
    played: int
    won: int
    drawn: int
    lost: int
    goals: int
    conceded: int
    by_faults: int
    points_for: int
    points_against: int
    difference: int
    points: int
    penalty: float
    forfeits: int
    rating: float
    uncertainty: float


class Standings(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """All rows, best first, how far the tournament is, the year whose rules apply, and the manifest's `inputs`."""

    rows: tuple[Row, ...]
    played: int
    games: int
    inputs: dict[str, str] = {}
    edition: str = DEFAULT

    def _repr_html_(self) -> str:
        return notebook.table(
            f"{self.played} of {self.games} games",
            ("", "name", "played", "won", "drawn", "lost", "goals", "points", "penalty", "rating"),
            (
                (row.rank, row.name, row.played, row.won, row.drawn, row.lost, f"{row.goals} : {row.conceded}", row.points,
                 f"{row.penalty:g}", f"{row.rating:.1f} ± {row.uncertainty:.1f}")
                for row in self.rows
            ),
        )  # fmt: skip


class _Score:
    """Adds up one entry's games."""

    def __init__(self) -> None:
        self.won = self.drawn = self.lost = self.forfeits = 0
        self.goals = self.conceded = self.by_faults = self.points_for = self.points_against = 0
        self.penalty = 0.0

    @property
    def points(self) -> int:
        return WIN * self.won + DRAW * self.drawn

    @property
    def difference(self) -> int:
        return self.points_for - self.points_against

    @property
    def key(self) -> tuple[int, int, int]:
        return self.points, self.difference, self.points_for


def standings(
    names: Sequence[str], jobs: Sequence[GameJob], records: Iterable[GameRecord], edition: str = DEFAULT
) -> Standings:
    """The standings after some of the scheduled games.

    Args:
        names: Of the entries.
        jobs: The schedule.
        records: Of games played, in any order; games that are not of the schedule do not count.
        edition: The year whose rules apply.
    """
    played = in_order(list(records), [job.key for job in jobs])
    scores = {name: _Score() for name in names}
    for record in played:
        _add(scores[record.job.home], record, home=True)
        _add(scores[record.job.away], record, home=False)
    ratings = _ratings(names, played)
    rows = []
    for rank, name in enumerate(_ranked(names, scores, played), start=1):
        score = scores[name]
        rows.append(
            Row(
                rank=rank,
                name=name,
                played=score.won + score.drawn + score.lost,
                won=score.won,
                drawn=score.drawn,
                lost=score.lost,
                goals=score.goals,
                conceded=score.conceded,
                by_faults=score.by_faults,
                points_for=score.points_for,
                points_against=score.points_against,
                difference=score.difference,
                points=score.points,
                penalty=score.penalty,
                forfeits=score.forfeits,
                rating=ratings[name][0],
                uncertainty=ratings[name][1],
            )
        )
    return Standings(rows=tuple(rows), played=len(played), games=len(jobs), edition=edition)


def write_standings(path: Path, table: Standings) -> Standings:
    """Leave the standings as standings.json and standings.csv."""
    with disk_errors(path):
        write_record(path / "standings.json", table)
        replace_file(path / "standings.csv", as_csv(table).encode())
    return table


def as_csv(table: Standings) -> str:
    """The rows as comma-separated values, with a head line."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(Row.__struct_fields__)
    writer.writerows([getattr(row, field) for field in Row.__struct_fields__] for row in table.rows)
    return text.getvalue()


def _add(score: _Score, record: GameRecord, home: bool) -> None:
    mine, theirs = (record.home, record.away) if home else (record.away, record.home)
    score.goals += mine.goals
    score.conceded += theirs.goals
    score.by_faults += mine.points_by_faults
    score.points_for += mine.points
    score.points_against += theirs.points
    score.penalty += mine.penalty
    score.forfeits += mine.failure is not None
    if record.winner == "draw":
        score.drawn += 1
    elif (record.winner == "home") == home:
        score.won += 1
    else:
        score.lost += 1


def _ranked(names: Sequence[str], scores: dict[str, _Score], played: Sequence[GameRecord]) -> list[str]:
    """The names, best first."""
    ranked: list[str] = []
    by_key = sorted(names, key=lambda name: scores[name].key, reverse=True)
    for _, group in groupby(by_key, key=lambda name: scores[name].key):
        tied = list(group)
        among = {name: _Score() for name in tied}
        for record in played:
            if record.job.home in among and record.job.away in among:
                _add(among[record.job.home], record, home=True)
                _add(among[record.job.away], record, home=False)
        ranked += sorted(tied, key=lambda name: (-among[name].points, scores[name].penalty, name))
    return ranked


def _ratings(names: Sequence[str], played: Sequence[GameRecord]) -> dict[str, tuple[float, float]]:
    """Mean and standard deviation of every entry's skill."""
    from openskill.models import PlackettLuce

    model: Any = PlackettLuce()
    ratings = {name: model.rating(name=name) for name in names}
    for record in played:
        pair = record.job.home, record.job.away
        ranks = {"home": [1, 2], "away": [2, 1], "draw": [1, 1]}[record.winner]
        rated = model.rate([[ratings[name]] for name in pair], ranks=ranks)
        for name, (rating,) in zip(pair, rated, strict=True):
            ratings[name] = rating
    return {name: (float(rating.mu), float(rating.sigma)) for name, rating in ratings.items()}
