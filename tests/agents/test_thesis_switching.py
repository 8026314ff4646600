"""The switcher and the state machine, exhaustively."""

import dataclasses
import itertools

import numpy as np
import pytest

from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.skill import Situation
from airhockey.agents.thesis.state_machine import StateMachine, Task, following
from airhockey.agents.thesis.switcher import Switcher, SwitcherParameters

PARAMETERS = SwitcherParameters(
    defend_speed=0.3,
    approach_speed=0.1,
    reach_x=0.0,
    side_tolerance=0.0,
    end_tolerance=0.0,
    look_ahead=0.0,
    leave_home_early=True,
)
EVERYTHING = frozenset(Task)


def view(x, y, vx=0.0, vy=0.0):
    state = np.array([x, y, vx, vy, 0.0])
    return Situation(PuckEstimate(state, np.eye(5), 0), np.array([-0.86, 0.0]), np.zeros(2), None, 0.02)


ALLOWED = {
    Task.HOME: {Task.HOME, Task.HIT, Task.DEFEND, Task.PREPARE},
    Task.HIT: {Task.HIT, Task.HOME},
    Task.DEFEND: {Task.DEFEND, Task.HOME},
    Task.PREPARE: {Task.PREPARE, Task.HOME},
}
"""Figure 4.6: the edges that leave each state."""


@pytest.mark.parametrize(("state", "suggested"), list(itertools.product(Task, Task)))
def test_only_the_edges_of_the_figure_are_taken(state, suggested):
    after = following(state, suggested)
    assert after in ALLOWED[state]
    assert after is (suggested if suggested in ALLOWED[state] else Task.HOME)


@pytest.mark.parametrize(("state", "suggested", "finished"), list(itertools.product(Task, Task, [False, True])))
def test_a_task_goes_on_until_it_is_finished(state, suggested, finished):
    machine = StateMachine()
    machine.state = state
    assert machine.advance(suggested, finished) is (following(state, suggested) if finished else state)


def test_a_game_starts_at_home():
    machine = StateMachine()
    machine.advance(Task.HIT, True)
    assert machine.state is Task.HIT
    machine.reset()
    assert machine.state is Task.HOME


FAST, SLOW = 0.5, 0.2
CASES = {
    # (where the puck is, how it moves): what to do
    ("open", "rest"): Task.HIT,
    ("open", "comes fast"): Task.DEFEND,
    ("open", "comes slowly"): Task.HIT,
    ("open", "leaves fast"): Task.HIT,
    ("open", "crosses fast"): Task.HIT,
    ("border", "rest"): Task.PREPARE,
    ("border", "comes fast"): Task.DEFEND,
    ("border", "comes slowly"): Task.PREPARE,
    ("border", "leaves fast"): Task.PREPARE,
    ("border", "crosses fast"): Task.PREPARE,
    ("opponent's", "rest"): Task.HOME,
    ("opponent's", "comes fast"): Task.DEFEND,
    ("opponent's", "comes slowly"): Task.HOME,
    ("opponent's", "leaves fast"): Task.HOME,
    ("opponent's", "crosses fast"): Task.HOME,
}
PLACES = {"open": (-0.5, 0.1), "border": (-0.5, 0.45), "opponent's": (0.4, 0.0)}
MOTIONS = {
    "rest": (0.0, 0.0),
    "comes fast": (-FAST, 0.0),
    "comes slowly": (-SLOW, 0.0),
    "leaves fast": (FAST, 0.0),
    "crosses fast": (0.0, FAST),
}


@pytest.mark.parametrize(("place", "motion"), list(itertools.product(PLACES, MOTIONS)))
def test_the_switchers_table(place, motion):
    assert Switcher(PARAMETERS, EVERYTHING).choose(view(*PLACES[place], *MOTIONS[motion])) is CASES[place, motion]


@pytest.mark.parametrize("tasks", [frozenset({Task.DEFEND}), frozenset({Task.PREPARE}), frozenset()])
@pytest.mark.parametrize(("place", "motion"), list(itertools.product(PLACES, MOTIONS)))
def test_a_task_that_is_not_played_means_home(tasks, place, motion):
    wanted = CASES[place, motion]
    chosen = Switcher(PARAMETERS, tasks).choose(view(*PLACES[place], *MOTIONS[motion]))
    assert chosen is (wanted if wanted in tasks else Task.HOME)


def test_the_thresholds_are_the_parameters():
    switcher = Switcher(PARAMETERS, EVERYTHING)
    assert switcher.choose(view(0.2, 0.0, -0.29)) is Task.HOME
    assert switcher.choose(view(0.2, 0.0, -0.31)) is Task.DEFEND
    assert switcher.choose(view(0.2, 0.0, -0.09, 0.5)) is Task.HOME  # fast, but hardly towards the goal


def test_looking_ahead_asks_where_the_puck_will_lie():
    ahead = dataclasses.replace(PARAMETERS, look_ahead=3.0)
    drifting = view(-0.5, 0.3, 0.0, 0.2)
    assert Switcher(PARAMETERS, EVERYTHING).choose(drifting) is Task.HIT
    assert Switcher(ahead, EVERYTHING).choose(drifting) is Task.PREPARE
