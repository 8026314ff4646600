"""Penalties of a game, and who wins it."""

import msgspec
import numpy as np
import pytest
from games import Clock, Stander, new_game, side

from airhockey.envs.editions import edition
from airhockey.evaluator.isolation.handle import LocalAgent
from airhockey.evaluator.judging.games import PenaltyCount, game_class, penalty_limit, tally, winner
from airhockey.evaluator.play.game import GamePlay
from airhockey.evaluator.runs.game_records import Event, Variant

RULES = edition()
WHOLE = 45000


def test_the_limit_is_135_for_a_whole_game() -> None:
    assert penalty_limit(RULES, WHOLE) == 135.0
    assert penalty_limit(RULES, 500) == 1.5


@pytest.mark.parametrize(
    ("penalty", "expected"),
    [(45.0, "Deployable"), (45.5, "Improvable"), (135.0, "Improvable"), (135.5, "Non-deployable")],
)
def test_the_class_is_that_of_1000_episodes_at_this_rate(penalty: float, expected: str) -> None:
    """500 and 1500 points in 1000 episodes are 45 and 135 in the 90 of a game."""
    assert game_class(RULES, penalty, WHOLE) == expected


@pytest.mark.parametrize(
    ("home", "away", "package", "thesis"),
    [
        (side(3), side(2), "home", "home"),
        (side(2), side(3), "away", "away"),
        (side(2), side(2), "draw", "draw"),
        (side(1, points_by_faults=2), side(2), "home", "home"),  # a point is a point
        (side(3, 135.0), side(2), "home", "home"),
        (side(3, 135.5), side(2), "draw", "away"),
        (side(2), side(3, 135.5), "draw", "home"),
        (side(3), side(2, 135.5), "home", "home"),
        (side(2, 135.5), side(2), "draw", "away"),
        (side(2, 200.0), side(3, 135.5), "draw", "draw"),
        (side(0, failure="crashed"), side(0), "away", "away"),
        (side(9, failure="crashed"), side(0, 300.0), "away", "away"),
        (side(0), side(9, failure="crashed"), "home", "home"),
        (side(1, failure="crashed"), side(0, failure="crashed"), "draw", "draw"),
    ],
)
def test_who_wins_in_both_variants_of_the_rules(home: object, away: object, package: str, thesis: str) -> None:
    assert winner(RULES, "package", WHOLE, home, away) == package
    assert winner(RULES, "thesis", WHOLE, home, away) == thesis


def test_wins_draws_and_losses_are_homes() -> None:
    assert tally(["home", "away", "home", "draw"]) == (2, 1, 1)


def test_a_constraint_counts_once_per_episode() -> None:
    count = PenaltyCount(RULES)
    every = {"joint_pos_constr": True, "joint_vel_constr": True, "ee_constr": True, "link_constr": True}
    assert count.add_episode(every, 0.0, 0.0) == {
        "joint_pos_constr": 2.0,
        "joint_vel_constr": 1.0,
        "ee_constr": 3.0,
        "link_constr": 3.0,
    }
    assert count.points == 9.0
    assert count.add_episode(dict.fromkeys(every, False), 0.0, 0.0) == {}
    count.add_episode({**dict.fromkeys(every, False), "ee_constr": True}, 0.0, 0.0)
    assert count.points == 12.0
    assert count.violations["ee_constr"] == 2


@pytest.mark.parametrize(
    ("longest", "mean", "points"),
    [
        (0.02, 0.02, 0.0),
        (0.021, 0.001, 0.5),
        (0.1, 0.001, 0.5),
        (0.11, 0.001, 1.0),
        (0.2, 0.001, 1.0),
        (0.21, 0.001, 2.0),
        (0.03, 0.021, 2.0),
    ],
)
def test_points_for_computation_time(longest: float, mean: float, points: float) -> None:
    count = PenaltyCount(RULES)
    count.add_episode({}, longest, mean)
    assert count.points == points
    assert count.violations["computation_time"] == bool(points)


class Reacher(Stander):
    """Lifts its mallet from the table from one step of the game to another, and then lowers it again."""

    def __init__(self, env: object, side: int, first: int, last: int) -> None:
        super().__init__(env, side)
        self.steps, self.lift, self.when = 0, 0.0, range(first, last + 1)

    def draw_action(self, observation: np.ndarray) -> np.ndarray:
        action = super().draw_action(observation)
        self.steps += 1
        self.lift += 0.003 if self.steps in self.when else max(-0.003, -self.lift)
        action[0, 3] += self.lift
        return action


def played(first: int, last: int, steps: int) -> GamePlay:
    game = new_game(steps=steps)
    game.seats[0].agent = LocalAgent(Reacher(game.env, 0, first, last))
    return game


def test_an_episode_of_penalties_is_500_steps() -> None:
    """A violation that lasts from step 480 to 520 or so counts in both episodes, and in no third one."""
    record = played(480, 520, 1100).play()
    assert record.home.violations["ee_constr"] == 2
    assert record.home.penalty == 6.0
    assert record.away.penalty == 0.0
    violations = [event for event in record.events if event.what == "violation"]
    assert [event.who for event in violations] == ["home", "home"]
    assert 480 <= violations[0].step <= 500
    assert violations[1].step == 501
    assert (violations[0].why or "").startswith("ee_constr: 3 points for this episode")
    assert sum(event.points for event in violations) == record.home.penalty
    assert [event.step for event in record.events] == sorted(event.step for event in record.events)


def test_the_rest_of_a_game_is_an_episode_too() -> None:
    record = played(505, 560, 560).play()
    assert record.home.violations["ee_constr"] == 1
    assert record.home.penalty == 3.0


@pytest.mark.parametrize(("variant", "expected"), [("package", "draw"), ("thesis", "away")])
def test_the_better_scorer_beyond_the_limit(variant: Variant, expected: str) -> None:
    """Home leads, but 3 points in 500 steps are more than 1.5."""
    game = played(10, 60, 100)
    game.options = type(game.options)(steps=100, variant=variant)
    game.begin()
    game.env.game.score[0] = 5
    game.log.goals[0] = 5
    for _ in range(100):
        game.step()
    record = game.end()
    assert record.home.penalty == 3.0
    assert record.score == (5, 0)
    assert record.home.deployability == "Non-deployable"
    assert record.winner == expected


def test_computation_time_is_judged_per_episode(monkeypatch: pytest.MonkeyPatch) -> None:
    """0.15 s once in the first 500 steps, 0.03 s once in the second, none in the third: 1 + 0.5 points."""
    clock = Clock()
    game = new_game(monkeypatch, clock, steps=1500)
    steps = iter(range(1, 1501))

    def think() -> None:
        clock.time += {100: 0.15, 700: 0.03}.get(next(steps), 0.001)

    game.seats[0].agent = LocalAgent(Stander(game.env, 0, think=think))
    record = game.play()
    assert (record.home.penalty, record.away.penalty) == (1.5, 0.0)
    assert record.home.violations["computation_time"] == 2
    assert record.home.held == 2
    assert record.home.computation_time.max == pytest.approx(0.15)
    assert [(event.step, event.what) for event in record.events if event.who == "home" and event.what != "serve"][
        :2
    ] == [
        (100, "held"),
        (100, "violation"),
    ]


def test_an_event_of_an_old_journal_has_no_points_and_one_without_points_is_written_as_before() -> None:
    line = b'{"step":3,"what":"violation","who":"home","why":"ee_constr: 3 points for this episode, up to 1 beyond"}'
    event = msgspec.json.decode(line, type=Event)
    assert event.points == 0.0
    assert msgspec.json.encode(event) == line
    assert (
        msgspec.json.decode(msgspec.json.encode(msgspec.structs.replace(event, points=2.5)), type=Event).points == 2.5
    )
