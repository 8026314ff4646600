"""Standings from constructed records: points, every tie-break, ratings."""

import csv
import io
import itertools
import random
from collections.abc import Sequence

from games import side

from airhockey.evaluator.judging.standings import Row, as_csv, standings
from airhockey.evaluator.runs.game_records import Event, GameJob, GameRecord

Result = tuple[str, str, int, int]


def record(home: str, away: str, scored: int, conceded: int, **penalty: float) -> GameRecord:
    """A game, won by who has more points; `penalty` is by name."""
    winner = "home" if scored > conceded else "away" if conceded > scored else "draw"
    return GameRecord(
        job=GameJob(f"1/{home}-{away}", home, away, home, away, 0),
        steps=1,
        home=side(scored, penalty.get(home, 0.0)),
        away=side(conceded, penalty.get(away, 0.0)),
        winner=winner,
        events=(Event(step=0, what="serve"),),
    )


def table(names: str, results: Sequence[Result], **penalty: float) -> dict[str, Row]:
    """The standings of a double round robin in which games that are not given are goalless draws; by rank."""
    played = {(home, away): record(home, away, h, a, **penalty) for home, away, h, a in results}
    for home, away in itertools.permutations(names, 2):
        played.setdefault((home, away), record(home, away, 0, 0, **penalty))
    records = list(played.values())
    rows = standings(list(names), [game.job for game in records], records).rows
    assert [row.rank for row in rows] == list(range(1, len(names) + 1))
    return {row.name: row for row in rows}


def ranking(names: str, *results: Result, **penalty: float) -> str:
    return "".join(table(names, results, **penalty))


def test_three_points_for_a_win_and_one_for_a_draw() -> None:
    rows = table("abc", [("a", "b", 2, 1), ("b", "a", 0, 4), ("c", "b", 0, 1)])
    a = rows["a"]
    assert (a.played, a.won, a.drawn, a.lost, a.points) == (4, 2, 2, 0, 8)
    assert (a.goals, a.conceded, a.difference) == (6, 1, 5)
    assert [row.points for row in rows.values()] == [8, 4, 3]
    assert "".join(rows) == "abc"


def test_points_come_first() -> None:
    """b has a worse goal difference than c, but more points."""
    assert ranking("abc", ("b", "a", 1, 0), ("b", "c", 1, 0), ("c", "b", 9, 0)) == "bca"


def test_then_goal_difference() -> None:
    assert ranking("abc", ("a", "c", 1, 0), ("b", "c", 3, 0)) == "bac"


def test_then_goals() -> None:
    """a and b have 4 points and a difference of 1 each; b scored more."""
    assert ranking("abc", ("a", "c", 1, 0), ("b", "c", 3, 2)) == "bac"


def test_then_the_games_among_those_tied() -> None:
    """a and b: as many points, +0, two goals each; b beat a."""
    results = (("b", "a", 2, 1), ("a", "c", 1, 0), ("c", "b", 1, 0))
    rows = table("abc", results)
    assert [(row.points, row.difference, row.goals) for row in (rows["a"], rows["b"])] == [(5, 0, 2), (5, 0, 2)]
    assert list(rows).index("b") < list(rows).index("a")
    assert ranking("abc", *results, b=100.0) == ranking("abc", *results)  # penalty comes after it


def test_then_fewer_penalty_points() -> None:
    assert ranking("abc", a=2.0, b=1.0, c=3.0) == "bac"


def test_goals_are_goals_and_points_by_faults_stand_apart() -> None:
    """b wins the score board by faults alone, and ranks by it."""
    jobs = [GameJob("1/a-b", "a", "b", "a", "b", 0)]
    game = GameRecord(job=jobs[0], steps=1, home=side(2), away=side(1, points_by_faults=3), winner="away", events=())
    b, a = standings(["a", "b"], jobs, [game]).rows
    assert (b.name, b.goals, b.conceded, b.by_faults, b.points_for, b.points_against, b.difference) == (
        "b",
        1,
        2,
        3,
        4,
        2,
        2,
    )
    assert (a.name, a.goals, a.conceded, a.by_faults, a.points_for, a.points_against, a.difference) == (
        "a",
        2,
        1,
        0,
        2,
        4,
        -2,
    )


def test_ties_are_broken_by_the_score_board_not_by_goals() -> None:
    games = []
    for home, away, mine in (("a", "c", side(2)), ("b", "c", side(0, points_by_faults=3))):
        job = GameJob(f"1/{home}-{away}", home, away, home, away, 0)
        games.append(GameRecord(job=job, steps=1, home=mine, away=side(), winner="home", events=()))
    rows = standings(["a", "b", "c"], [game.job for game in games], games).rows
    assert [row.name for row in rows] == ["b", "a", "c"]


def test_then_the_name() -> None:
    assert ranking("cab") == "abc"


def test_games_that_are_not_played_yet_or_not_of_the_schedule_do_not_count() -> None:
    jobs = [GameJob(f"1/{home}-{away}", home, away, home, away, 0) for home, away in (("a", "b"), ("b", "a"))]
    result = standings(["a", "b"], jobs, [record("b", "a", 0, 1), record("a", "z", 5, 0)])
    assert (result.played, result.games) == (1, 2)
    assert [(row.name, row.goals) for row in result.rows] == [("a", 1), ("b", 0)]


def test_ratings_do_not_depend_on_the_order_of_play() -> None:
    records = [record(h, a, *scores) for (h, a), scores in zip(itertools.permutations("abcd", 2), SCORES, strict=True)]
    jobs = [game.job for game in records]
    expected = standings(list("abcd"), jobs, records)
    for seed in range(5):
        random.Random(seed).shuffle(records)
        assert standings(list("abcd"), jobs, records) == expected


SCORES = [(1, 0), (2, 2), (0, 3), (4, 1), (0, 0), (1, 2), (3, 1), (0, 1), (2, 0), (1, 1), (5, 0), (0, 2)]


def test_ratings_rise_with_wins_and_get_certain_with_games() -> None:
    rows = table("ab", [("a", "b", 3, 0), ("b", "a", 0, 1)])
    assert rows["a"].rating > 25.0 > rows["b"].rating
    assert rows["a"].uncertainty < 25.0 / 3.0
    fresh = standings(["a", "b"], [], []).rows[0]
    assert (fresh.rating, round(fresh.uncertainty, 2)) == (25.0, 8.33)


def test_a_forfeit_is_counted_and_loses_the_game() -> None:
    game = record("a", "b", 3, 1)
    forfeited = GameRecord(
        job=game.job, steps=1, home=side(3, failure="crashed"), away=side(1), winner="away", events=game.events
    )
    rows = {row.name: row for row in standings(["a", "b"], [game.job], [forfeited]).rows}
    assert (rows["a"].forfeits, rows["a"].lost, rows["b"].won, rows["b"].forfeits) == (1, 1, 1, 0)


def test_the_table_as_csv() -> None:
    records = [record("a", "b", 2, 1)]
    lines = list(csv.DictReader(io.StringIO(as_csv(standings(["a", "b"], [records[0].job], records)))))
    assert [(line["name"], line["goals"], line["difference"], line["points"]) for line in lines] == [
        ("a", "2", "1", "3"),
        ("b", "1", "-1", "0"),
    ]
