"""The rules on constructed states, with the numbers of the challenge's sections 4 and 6 and their boundaries."""

import math

import numpy as np
import pytest

from airhockey.envs.tasks import defend, hit, prepare, verdicts
from airhockey.envs.tasks.game import Game, judge_serve
from airhockey.envs.tasks.verdicts import Rules, off_table

HIT_WIDTH = 1.038 / 2 - 0.03165 - 2 * 0.04815
RULES = Rules(
    half_length=0.974,
    half_width=0.519,
    goal_half_width=0.125,
    max_speed=100.0,
    near_x=-0.8,
    far_x=-0.2,
    band_half_width=HIT_WIDTH,
    slow=0.1,
    standstill=0.1,
    middle_line=0.01,
    fault_time=15.0,
    faults_per_point=3,
    middle_zone=0.15,
    stuck_speed=0.025,
)


def puck(x, y, vx=0.0, vy=0.0, spin=0.0):
    return np.array([x, y, 0.3, vx, vy, spin])


def above(value):
    return math.nextafter(value, math.inf)


def below(value):
    return math.nextafter(value, -math.inf)


@pytest.mark.parametrize(
    ("state", "expected"),
    [
        (puck(0.974, 0.0), False),
        (puck(above(0.974), 0.0), True),
        (puck(-0.974, 0.0), False),
        (puck(below(-0.974), 0.0), True),
        (puck(0.0, 0.519), False),
        (puck(0.0, above(0.519)), True),
        (puck(0.0, below(-0.519)), True),
        (puck(0.0, 0.0, 60.0, 0.0, 80.0), False),  # its norm is 100 exactly
        (puck(0.0, 0.0, 60.0, 0.0, -80.001), True),
        (puck(0.0, 0.0, 0.0, 100.1), True),
    ],
)
def test_off_the_table_or_too_fast(state, expected):
    assert off_table(RULES, state) == expected


@pytest.mark.parametrize(
    ("kind", "state", "expected"),
    [
        (hit, puck(0.1, 0.2, -0.1), True),
        (hit, puck(0.1, 0.2, 0.0), False),
        (hit, puck(0.1, 0.2, 0.1), False),
        (hit, puck(0.0, 0.2, -0.1), False),
        (hit, puck(-0.1, 0.2, -0.1), False),
        (defend, puck(0.1, 0.2, 0.5), True),
        (defend, puck(0.1, 0.2, -0.5), False),
        (defend, puck(0.0, 0.2, 0.5), False),
        (defend, puck(-0.5, 0.2, 0.06, -0.08), False),  # its speed is 0.1 exactly
        (defend, puck(-0.5, 0.2, 0.06, -0.079), True),
        (defend, puck(-0.5, 0.2, 0.0, 0.0, 5.0), True),  # spin is no speed
        (prepare, puck(0.0, 0.2), False),
        (prepare, puck(1e-9, 0.2), True),
        (prepare, puck(-0.5, 0.01), False),
        (prepare, puck(-0.5, -0.009), True),
    ],
)
def test_the_task_is_over(kind, state, expected):
    assert kind.over(RULES, state) == expected


@pytest.mark.parametrize(
    ("kind", "state", "expected"),
    [
        (hit, puck(above(0.974), 0.0, 1.0), True),
        (hit, puck(0.974, 0.0, 1.0), False),
        (hit, puck(-1.0, 0.0), False),
        (hit, puck(1.0, below(0.125)), True),
        (hit, puck(1.0, -0.125), False),
        (defend, puck(-0.2, 0.5, 0.0), True),
        (defend, puck(above(-0.2), 0.0), False),
        (defend, puck(-0.8, 0.0), False),
        (defend, puck(above(-0.8), 0.0), True),
        (defend, puck(-0.5, 0.0, 0.1), False),
        (defend, puck(-0.5, 0.0, below(0.1), 3.0), True),
        (defend, puck(-0.5, 0.0, -2.0), True),
        (prepare, puck(-0.2, below(HIT_WIDTH)), True),
        (prepare, puck(-0.5, HIT_WIDTH), False),
        (prepare, puck(-0.5, -0.45), False),
        (prepare, puck(-0.8, 0.0), False),
        (prepare, puck(-0.5, 0.0, 0.1), False),
        (prepare, puck(-0.1, 0.0), False),
    ],
)
def test_success(kind, state, expected):
    assert kind.succeeded(RULES, state) == expected


def game(serve=1):
    return Game(np.zeros(2, np.int64), np.zeros(2, np.int64), np.zeros(1, np.int64), np.array([serve]), np.zeros(1))


def steps_until_something(state, match, limit=2000):
    """Judge a puck that does not move until something happens; the step and what it was."""
    for step in range(1, limit):
        verdict = judge_serve(RULES, match, state)
        if verdict != verdicts.GOING_ON:
            return step, verdict
    return limit, verdicts.GOING_ON


@pytest.mark.parametrize(
    ("state", "verdict", "score", "serve"),
    [
        (puck(0.98, 0.125), verdicts.GOAL_HOME, [1, 0], -1),  # player 2 conceded and serves
        (puck(0.98, -0.1, -1.0), verdicts.GOAL_HOME, [1, 0], -1),
        (puck(-0.98, 0.0), verdicts.GOAL_AWAY, [0, 1], 1),
        (puck(-0.98, -0.125), verdicts.GOAL_AWAY, [0, 1], 1),
        (puck(0.974, 0.0), verdicts.GOING_ON, [0, 0], 1),
        (puck(0.98, above(0.125)), verdicts.OFF_TABLE, [0, 0], 1),
        (puck(0.3, 0.52), verdicts.OFF_TABLE, [0, 0], 1),
        (puck(0.3, 0.1, 0.0, 0.0, 120.0), verdicts.OFF_TABLE, [0, 0], 1),
    ],
)
def test_goals_and_who_serves_next(state, verdict, score, serve):
    match = game()
    assert judge_serve(RULES, match, state) == verdict
    assert match.score.tolist() == score
    assert match.faults.tolist() == [0, 0]
    assert match.serve[0] == serve


@pytest.mark.parametrize(
    ("x", "verdict", "faults", "serve"),
    [
        (-0.5, verdicts.FAULT_HOME, [1, 0], -1),
        (0.5, verdicts.FAULT_AWAY, [0, 1], 1),
        (-0.15, verdicts.FAULT_HOME, [1, 0], -1),
    ],
)
def test_a_puck_left_alone_faults_on_the_752nd_step_and_the_other_side_serves(x, verdict, faults, serve):
    match = game(serve=-serve)
    assert steps_until_something(puck(x, 0.2), match) == (752, verdict)
    assert match.faults.tolist() == faults
    assert match.score.tolist() == [0, 0]
    assert match.serve[0] == serve


def test_fifteen_seconds_are_not_yet_too_long():
    match = game()
    match.side[0], match.timer[0] = -1, 14.98
    assert judge_serve(RULES, match, puck(-0.5, 0.2)) == verdicts.GOING_ON
    assert match.timer[0] == 15.0
    assert judge_serve(RULES, match, puck(-0.5, 0.2)) == verdicts.FAULT_HOME


def test_changing_sides_restarts_the_timer():
    match = game()
    for _ in range(700):
        assert judge_serve(RULES, match, puck(-0.5, 0.2)) == verdicts.GOING_ON
    assert judge_serve(RULES, match, puck(0.5, 0.2)) == verdicts.GOING_ON
    assert match.timer[0] == 0.0
    step, verdict = steps_until_something(puck(0.5, 0.2), match)
    assert (step, verdict) == (751, verdicts.FAULT_AWAY)  # the first of the 752 was the change


def test_every_third_fault_is_a_point_for_the_opponent():
    match = game()
    for fault in range(1, 7):
        match.side[0] = 0  # a serve
        assert steps_until_something(puck(-0.5, 0.2), match) == (752, verdicts.FAULT_HOME)
        assert match.faults.tolist() == [fault, 0]
        assert match.score.tolist() == [0, fault // 3]


def test_faults_of_the_two_players_are_counted_apart():
    match = game()
    for x in (-0.5, 0.5, -0.5, 0.5):
        match.side[0] = 0
        steps_until_something(puck(x, 0.2), match)
    assert match.faults.tolist() == [2, 2]
    assert match.score.tolist() == [0, 0]


def test_no_fault_in_the_middle_but_as_soon_as_the_puck_leaves_it():
    match = game()
    moving = puck(-0.149, 0.2, 0.1)
    assert steps_until_something(moving, match, 800) == (800, verdicts.GOING_ON)
    assert match.faults.tolist() == [0, 0]
    assert judge_serve(RULES, match, puck(-0.15, 0.2, -0.1)) == verdicts.FAULT_HOME


def test_a_puck_beyond_the_time_that_is_stuck_in_the_middle_is_no_fault():
    match = game()
    steps_until_something(puck(-0.149, 0.2, 0.1), match, 800)
    assert judge_serve(RULES, match, puck(-0.1, 0.2, 0.0)) == verdicts.STUCK
    assert match.faults.tolist() == [0, 0]


@pytest.mark.parametrize(
    ("state", "verdict"),
    [
        (puck(0.1, 0.2, 0.024), verdicts.STUCK),
        (puck(-0.1, 0.2, -0.024, 2.0), verdicts.STUCK),  # only the velocity along x counts
        (puck(0.0, 0.2), verdicts.STUCK),
        (puck(0.1, 0.2, 0.025), verdicts.GOING_ON),
        (puck(0.15, 0.2, 0.0), verdicts.GOING_ON),
        (puck(below(0.15), 0.2, 0.0), verdicts.STUCK),
    ],
)
def test_stuck_in_the_middle_serves_again_from_the_same_side(state, verdict):
    for serve in (1, -1):
        match = game(serve)
        assert judge_serve(RULES, match, state) == verdict
        assert match.serve[0] == serve
        assert match.faults.tolist() == match.score.tolist() == [0, 0]
