"""The 15 s that a side may hold the puck: how they are counted, and what both players do when they run out."""

import numpy as np
import pytest

from airhockey.agents.control.workspace import Workspace
from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.estimation.side_clock import HURRY, SideClock
from airhockey.agents.planner.estimation.opponent import OpponentTrack
from airhockey.agents.planner.shots.kinds import ANY, OPEN
from airhockey.agents.planner.shots.parameters import smash_parameters
from airhockey.agents.planner.shots.shot_search import ShotPlanner
from airhockey.agents.skill import Situation
from airhockey.agents.table import HALF_LENGTH, to_robot
from airhockey.agents.thesis.parameters import thesis_parameters
from airhockey.agents.thesis.policy import TOLERANCE, enough_space
from airhockey.agents.thesis.state_machine import Task
from airhockey.agents.thesis.switcher import Switcher
from airhockey.envs.specs import IIWA

DT = 0.02


def seen(x: float, y: float = 0.0, held: float = 0.0) -> Situation:
    puck = PuckEstimate(np.array([x, y, 0.0, 0.0, 0.0]), 1e-6 * np.eye(5), 0)
    return Situation(puck, np.array([-0.86, 0.0]), np.zeros(2), np.array([0.86, 0.0]), DT, held=held)


def test_the_clock_counts_while_the_puck_is_on_our_side_and_no_longer() -> None:
    clock = SideClock(DT)
    assert [clock.see(x) for x in (-0.1, -0.5, 0.1, -0.1)] == pytest.approx([DT, 2 * DT, 0.0, DT])
    clock.reset()
    assert clock.held == 0.0


def test_in_a_hurry_the_thesis_player_hits_wherever_the_mallet_fits() -> None:
    x = -(HALF_LENGTH - TOLERANCE) + 0.01
    assert enough_space(np.array([x, 0.0]))
    switcher = Switcher(thesis_parameters("tuned").switcher, frozenset(Task))
    for _ in range(50):  # until it counts as resting
        calm = switcher.choose(seen(x))
    assert calm is Task.PREPARE
    assert switcher.choose(seen(x, held=HURRY + DT)) is Task.HIT
    assert switcher.choose(seen(-HALF_LENGTH + 0.05, 0.3, held=HURRY + DT)) is Task.PREPARE


def test_in_a_hurry_the_planner_shoots_past_no_one_too() -> None:
    """A keeper who will stop whatever comes is no reason to keep the puck for longer than the rules allow."""
    workspace = Workspace(to_robot(np.array([-0.918, -0.463])), to_robot(np.array([0.918, 0.463])), 6.0)
    parameters, env_info = smash_parameters(IIWA, in_game=True), {"dt": DT, "env_name": "tournament", "n_agents": 2}
    opponent = OpponentTrack(env_info)
    for step in range(5):
        opponent.update(np.array([0.86, 0.0]), step)
    now = seen(-0.6)
    for kind, worth_it in ((OPEN, False), (ANY, True)):
        planner = ShotPlanner(parameters, workspace, DT, least=2.0)  # a value that no shot has
        shots = [planner.plan(now, opponent, 10.0, kind) for _ in range(20)]
        assert (shots[-1] is not None) == worth_it
