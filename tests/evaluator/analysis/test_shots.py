"""Shots and saves, on trajectories with closed forms."""

import numpy as np
import pytest
from courses import KEEP, LATERAL, LINE, Course, K

from airhockey.agents.estimation.motion import puck_motion
from airhockey.envs.specs import CONTROL_PERIOD, TABLE
from airhockey.evaluator.analysis.shots import on_target


def shot(speed: float, y_speed: float = 0.0) -> Course:
    """A puck at rest on home's side, which home shoots."""
    return Course().slide(5).hit("home", speed, y_speed)


def test_a_shot_on_target_that_the_opponent_turns_back_is_saved() -> None:
    course = shot(2.0).slide_to(0.8)
    touched = len(course.rows) + 1
    saved = course.hit("away", -0.8, 0.0).slide(10).shots()
    assert [(one.side, one.step, one.outcome, one.touched) for one in saved] == [("home", 6, "saved", touched)]
    assert saved[0].speed == pytest.approx(2.0 * KEEP)
    assert [(one.side, one.outcome, one.touched) for one in course.mirrored()] == [("away", "saved", touched)]


def test_a_shot_that_would_have_come_to_rest_before_the_line_is_no_save() -> None:
    """Shot so that it comes to rest a centimetre before the goal line, or a centimetre behind it."""
    for rest, outcome in ((LINE - 0.01, "off target"), (LINE + 0.01, "saved")):
        course = Course().slide(5)
        course.hit("home", (rest - course.x) * K, 0.0).slide_to(0.3).hit("away", -0.4, 0.0).slide(10)
        assert course.outcomes() == [("home", outcome)]


def by_a_rim(y_at_line: float, speed: float = 3.0) -> Course:
    """A shot by home that ends at y on the goal line after a bounce at the upper rim at x = 0, touched at x = 0.6 by away."""
    motion = puck_motion()
    slope = (LATERAL - y_at_line) / LINE  # of the way from the bounce to the goal line
    before = slope * (1.0 - motion.slip_impulse) / motion.restitution
    course = Course(x=-0.2, y=LATERAL - 0.2 * before).slide(5).hit("home", speed, speed * before)
    while course.y < LATERAL - course.velocity[1] * CONTROL_PERIOD:
        course.slide(1)
    course.slide(1)
    course.x, course.y = 0.0, LATERAL
    return course.bounce().slide_to(0.6)


@pytest.mark.parametrize(
    ("y_at_line", "outcome"),
    [(0.0, "saved"), (TABLE.goal_width / 2 - 0.02, "saved"), (TABLE.goal_width / 2 + 0.02, "off target")],
)
def test_a_shot_by_a_rim_is_judged_by_where_it_ends(y_at_line: float, outcome: str) -> None:
    assert by_a_rim(y_at_line).hit("away", -0.5, 0.0).slide(5).outcomes() == [("home", outcome)]


@pytest.mark.parametrize("towards", [1.0, -1.0])
@pytest.mark.parametrize(("y_at_line", "inside"), [(0.0, True), (0.1, True), (0.15, False), (-0.15, False)])
def test_a_bounce_that_is_still_to_come_takes_its_share(y_at_line: float, inside: bool, towards: float) -> None:
    """The same path, judged before the bounce: a rim that mirrored the path would send it elsewhere."""
    motion = puck_motion()
    limit = LATERAL + motion.rim_give
    slope = (limit - y_at_line) / LINE * (1.0 - motion.slip_impulse) / motion.restitution
    puck = np.array([-0.2, limit - 0.2 * slope, 0.0, 3.0, 3.0 * slope, 0.0])
    assert on_target(puck * [towards, towards, 1.0, towards, towards, 1.0], towards) is inside


def test_a_shot_by_a_rim_comes_to_rest_before_the_line_too() -> None:
    """What the rim takes of the speed along it is missing at the goal line."""
    motion = puck_motion()
    left = LINE * K / (1.0 - motion.slip_impulse)  # speed before the bounce that reaches the line at rest
    limit = LATERAL + motion.rim_give
    slope = limit / LINE * (1.0 - motion.slip_impulse) / motion.restitution  # to the goal's middle
    for factor, inside in ((0.97, False), (1.03, True)):
        assert (
            on_target(np.array([-1e-4, limit - 1e-4 * slope, 0.0, factor * left, factor * left * slope, 0.0]), 1.0)
            is inside
        )


def test_what_goes_past_the_goal_is_off_target() -> None:
    assert shot(2.0, 0.5).slide_to(0.6).hit("away", -0.5, 0.0).slide(5).outcomes() == [("home", "off target")]


def test_what_the_shooter_touches_again_is_no_save() -> None:
    course = shot(2.0).slide_to(0.1)
    assert course.hit("home", 2.5, 0.0).slide_to(0.5).outcomes() == [("home", "off target")]


def test_a_goal_is_the_shooters_off_the_opponent_or_not() -> None:
    assert shot(2.0).slide_to(LINE).slide(2).score("home").outcomes() == [("home", "goal")]
    deflected = shot(2.0).slide_to(0.8).hit("away", 1.5, 0.1).slide_to(LINE).slide(1).score("home")
    assert deflected.outcomes() == [("home", "goal")]


def test_an_own_goal_is_nobodys_shot() -> None:
    course = Course(home=(-0.3, 0.0)).slide(5).hit("home", -1.5, 0.0).slide_to(-LINE).slide(1).score("away")
    assert course.outcomes() == []


def test_a_pass_on_ones_own_side_is_no_shot() -> None:
    assert shot(0.15).slide(100).outcomes() == []
