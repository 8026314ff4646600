"""Each of this project's additions to the thesis is a switch, and its file of parameters has them off."""

from dataclasses import replace

import numpy as np
import pytest

from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.skill import Situation
from airhockey.agents.table import HOME
from airhockey.agents.thesis.hit import HitPolicy
from airhockey.agents.thesis.home import HomePolicy
from airhockey.agents.thesis.opponent import OpponentWatch
from airhockey.agents.thesis.parameters import thesis_parameters
from airhockey.agents.thesis.state_machine import StateMachine, Task

DT = 0.02


def situation(puck: tuple[float, ...], tip: tuple[float, float], held: float = 0.0) -> Situation:
    """A puck (x, y, ẋ, ẏ) and our mallet, at rest."""
    state = PuckEstimate(np.array([*puck, 0.0]), np.eye(5) * 1e-6, 0)
    return Situation(state, np.array(tip), np.zeros(2), None, DT, held=held)


def test_the_thesis_text_has_all_additions_off() -> None:
    text = thesis_parameters("thesis")
    assert text.hit.keep_ds and not text.hit.follow and text.hit.gap == 0.0 and text.hit.across == 0.0
    assert not text.defend.predict and text.defend.cushion == 0.0
    assert not text.prepare.bank_shot
    assert not text.switcher.decide_once and not text.switcher.hurry and not text.switcher.leave_home_early
    assert text.switcher.look_ahead == 0.0
    assert text.state_machine and text.home.curved


def test_without_the_state_machine_tasks_follow_each_other_directly() -> None:
    with_it, without = StateMachine(), StateMachine(through_home=False)
    for machine in (with_it, without):
        machine.advance(Task.HIT, finished=True)
    assert with_it.advance(Task.DEFEND, finished=True) is Task.HOME
    assert without.advance(Task.DEFEND, finished=True) is Task.DEFEND
    assert without.advance(Task.HIT, finished=False) is Task.DEFEND  # a task is not broken off


@pytest.mark.parametrize("tip", [(-0.5, 0.3), (-0.5, -0.3)])
def test_a_straight_way_home_has_no_bow(tip: tuple[float, float]) -> None:
    parameters = thesis_parameters("thesis")
    for curved in (False, True):
        policy = HomePolicy(replace(parameters.home, curved=curved), parameters.hit.theta)
        move = policy.step(situation((0.6, 0.0, 0.0, 0.0), tip)).target - np.array(tip)
        way = HOME - np.array(tip)
        bow = abs(move[0] * way[1] - move[1] * way[0]) / (np.hypot(*move) * np.hypot(*way))
        assert (bow < 1e-9) is not curved


def test_the_printed_slow_down_keeps_ds() -> None:
    parameters = thesis_parameters("thesis").hit
    policy = HitPolicy(parameters, OpponentWatch(3.0, DT))
    policy.phase, policy._ds = "slow-down", 0.02
    tip, puck = np.array([-0.5, 0.0]), np.array([-0.3, 0.0])
    target = policy.step(situation((*puck, 0.0, 0.0), tuple(tip))).target
    assert np.hypot(*(puck - tip)) - np.hypot(*(puck - target)) == pytest.approx(0.02)
