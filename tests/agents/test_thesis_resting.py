"""A puck at rest is judged once, by the task's own borders (challenge's section 4), and not again until it has moved."""

import numpy as np
import pytest

from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.thesis.resting import ENOUGH, RestingPuck

NOISE = 0.0015
"""Of a filtered position, in [m]."""


def estimate(x: float, y: float, velocity: float = 0.0) -> PuckEstimate:
    return PuckEstimate(np.array([x, y, velocity, 0.0, 0.0]), np.eye(5), 0)


@pytest.mark.parametrize(
    ("x", "y", "playable"),
    [
        (-0.5, 0.0, True),
        (-0.79, 0.2, True),
        (-0.802, 0.2, False),
        (-0.815, 0.0, False),
        (-0.5, 0.38, True),
        (-0.5, 0.395, False),
    ],
)
def test_the_borders_are_those_of_the_task(x: float, y: float, playable: bool) -> None:
    resting, rng = RestingPuck(), np.random.default_rng(0)
    for _ in range(ENOUGH):
        assert resting.playable is None
        resting.see(estimate(x + NOISE * rng.normal(), y + NOISE * rng.normal(), 0.02 * rng.normal()))
    assert resting.playable is playable


def test_noise_does_not_change_a_decision() -> None:
    resting, rng = RestingPuck(), np.random.default_rng(1)
    for _ in range(ENOUGH):
        resting.see(estimate(-0.796, 0.0))
    decided = resting.playable
    for _ in range(300):
        resting.see(estimate(-0.796 + NOISE * np.clip(rng.normal(), -3, 3), 0.0))
        assert resting.playable is decided


def test_a_puck_that_moves_is_judged_anew_and_a_rolling_one_not_at_all() -> None:
    resting = RestingPuck()
    for _ in range(ENOUGH):
        resting.see(estimate(-0.85, 0.0))
    assert resting.playable is False
    resting.see(estimate(-0.80, 0.0))
    assert resting.playable is None
    for k in range(3 * ENOUGH):
        resting.see(estimate(-0.8 + 0.001 * k, 0.0, 0.05))
    assert resting.playable is None
