"""What the planner learns of a table, from pucks that slide with a known damping and bounce with a known restitution."""

import numpy as np
import pytest

from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.estimation.motion import advance, puck_motion
from airhockey.agents.planner.estimation.table_learning import TableLearning
from airhockey.agents.skill import Situation

FAR = np.array([-0.86, 0.0])
DAMPING, RESTITUTION = 3, 5  # places in the constants of `PuckMotion`


def watch(
    learning: TableLearning, start: list[float], steps: int, constants: np.ndarray, tip: np.ndarray = FAR
) -> None:
    state = np.array(start)
    for _ in range(steps):
        learning.see(Situation(PuckEstimate(state.copy(), np.eye(5), 0), tip, np.zeros(2), np.array([0.86, 0.0])))
        advance(state, 0.02, constants)


def table(damping: float = 0.5, restitution: float = 0.742) -> np.ndarray:
    constants = puck_motion().constants
    constants[DAMPING], constants[RESTITUTION] = damping, restitution
    return constants


@pytest.mark.parametrize("damping", [0.4, 0.6])
def test_the_damping_is_learned_from_slides(damping: float) -> None:
    learning = TableLearning()
    for _ in range(4):
        watch(learning, [-0.6, 0.1, 1.2, 0.4, 0.0], 120, table(damping))
    assert learning.damping == pytest.approx(damping, abs=0.03)
    learning.reset()
    assert learning.damping == 0.5


def test_the_restitution_of_lively_rims_is_learned_from_bounces() -> None:
    learning = TableLearning()
    for _ in range(12):
        watch(learning, [-0.5, 0.2, 0.3, 1.0, 0.0], 60, table(restitution=1.0))
    assert 0.88 < learning.restitution < 1.03


def test_an_ordinary_table_stays_as_it_was_believed() -> None:
    learning = TableLearning()
    for _ in range(6):
        watch(learning, [-0.6, 0.1, 1.2, 0.7, 0.0], 120, table())
    assert learning.damping == pytest.approx(0.5, abs=0.005)
    assert learning.restitution == pytest.approx(0.742, abs=0.02)


def test_nothing_is_learned_beside_a_mallet() -> None:
    learning = TableLearning()
    watch(learning, [-0.6, 0.1, 0.3, 0.0, 0.0], 60, table(0.9), tip=np.array([-0.5, 0.2]))
    assert learning.damping == 0.5
