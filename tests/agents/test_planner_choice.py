"""The choice between kinds of shots: what a stroke has brought, by the rules of serves; and that the choice follows it."""

import numpy as np
import pytest

from airhockey.agents.planner.estimation.choice import Arms
from airhockey.agents.planner.estimation.outcome import FAULT, FLIGHT, Outcome

DT = 0.02


def watch(outcome: Outcome, seconds: float, x: float) -> list[tuple[str, float]]:
    return [told for _ in range(round(seconds / DT)) for told in outcome.see(x, DT)]


def test_a_serve_from_their_side_after_a_stroke_is_a_goal() -> None:
    """Who has conceded serves."""
    outcome = Outcome()
    outcome.struck("rim")
    assert watch(outcome, 1.5, 0.5) == []
    outcome.serve()
    assert watch(outcome, 1.0, 0.4) == [("rim", 1.0)]


def test_a_serve_from_our_side_soon_after_a_stroke_is_none() -> None:
    outcome = Outcome()
    outcome.struck("rim")
    watch(outcome, 1.5, 0.5)
    outcome.serve()
    assert watch(outcome, 1.0, -0.4) == [("rim", 0.0)]


def test_a_puck_left_on_their_side_until_the_referee_comes_is_a_third_of_a_point() -> None:
    """Three faults are a point, and the puck is served on the other side."""
    outcome = Outcome()
    outcome.struck("drop")
    assert watch(outcome, 15.1, 0.8) == [("drop", 0.0)]
    outcome.serve()
    assert watch(outcome, 1.0, -0.4) == [("drop", FAULT)]
    assert pytest.approx(1.0) == 3 * FAULT


def test_a_goal_that_we_concede_is_no_fault_of_theirs() -> None:
    outcome = Outcome()
    outcome.struck("open")
    watch(outcome, FLIGHT + 0.1, 0.5)
    watch(outcome, 1.0, -0.95)
    outcome.serve()
    assert watch(outcome, 1.0, -0.4) == []


def test_a_stroke_is_in_vain_once_the_next_one_is_played() -> None:
    outcome = Outcome()
    outcome.struck("rim")
    watch(outcome, 1.0, 0.5)
    outcome.struck("open")
    assert watch(outcome, FLIGHT + 0.1, 0.5) == [("rim", 0.0), ("open", 0.0)]


def test_the_arm_that_scores_is_played_more_and_more() -> None:
    chances = {"a": 0.02, "b": 0.3, "c": 0.02}
    arms, rng = Arms(dict.fromkeys(chances, 0.05), 8.0), np.random.default_rng(0)
    for _ in range(150):
        arm = arms.draw()
        assert arm is not None
        arms.tell(arm, float(rng.uniform() < chances[arm]))
    assert arms.tries["b"] > 100 and min(arms.tries.values()) > 0


def test_arms_that_cannot_be_played_are_passed_over_and_games_repeat() -> None:
    first, second = (Arms({"a": 0.5, "b": 0.1}, 8.0) for _ in range(2))
    assert [first.draw() for _ in range(20)] == [second.draw() for _ in range(20)]
    assert first.draw(without={"a"}) == "b"
    assert first.draw(without={"a", "b"}) is None
