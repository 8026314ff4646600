"""The drop: the puck dies where it should."""

import numpy as np
import pytest

from airhockey.agents.control.workspace import Workspace
from airhockey.agents.estimation.motion import advance, puck_motion
from airhockey.agents.planner.estimation.rest_prediction import RestPrediction
from airhockey.agents.planner.shots.parameters import smash_parameters
from airhockey.agents.planner.shots.shot_model import ShotModel, make_shot_model
from airhockey.agents.planner.skills.dead_puck import GAIN, PLACE, Timing, roll
from airhockey.agents.table import CONTACT, to_robot
from airhockey.envs.specs import IIWA

TIP = np.array([-0.86, 0.0])
DT = 0.02


@pytest.fixture(scope="module")
def model() -> ShotModel:
    workspace = Workspace(to_robot(np.array([-0.918, -0.463])), to_robot(np.array([0.918, 0.463])), 6.0)
    return make_shot_model(smash_parameters(IIWA), workspace)._replace(turn=0.0)


@pytest.mark.parametrize("puck", [(-0.6, 0.0), (-0.55, 0.2), (-0.4, -0.3), (-0.65, -0.1)])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_puck_comes_to_rest_at_the_place(puck: tuple[float, float], side: float, model: ShotModel) -> None:
    place = PLACE * np.array([1.0, side])
    shot = roll(np.array([*puck, 0.0, 0.0, 0.0]), Timing(2.0, 0.0), place, GAIN, TIP, model)
    assert shot.value == 1.0 and shot.wall == side
    assert np.hypot(*(shot.mallet - puck)) == pytest.approx(CONTACT)
    state = np.array([*puck, *(GAIN * shot.speed * shot.normal), 0.0])
    advance(state, 30.0, puck_motion().constants)
    assert state[:2] == pytest.approx(place, abs=1e-3)


def test_a_drop_needs_time_to_get_behind_the_puck(model: ShotModel) -> None:
    puck = np.array([-0.6, 0.0, 0.0, 0.0, 0.0])
    assert roll(puck, Timing(0.1, 0.0), PLACE, GAIN, TIP, model).value == 0.0


def test_a_puck_beyond_reach_cannot_be_dropped(model: ShotModel) -> None:
    assert roll(np.array([0.1, 0.0, 0.0, 0.0, 0.0]), Timing(2.0, 0.0), PLACE, GAIN, TIP, model).value == 0.0


@pytest.mark.parametrize("damping", [0.4, 0.5, 0.6])
@pytest.mark.parametrize("place", [0.7, 0.9, 1.2])
def test_the_watch_tells_where_a_puck_will_rest_whatever_its_damping(damping: float, place: float) -> None:
    watch, told = RestPrediction(DT), []
    for k in range(300):
        told.append(watch.see(place - (place + 0.55) * np.exp(-damping * k * DT)))
    (rest,) = [answer for answer in told if answer is not None]
    assert rest == pytest.approx(place, abs=0.01)


def test_the_watch_tells_nothing_of_a_puck_that_is_stopped() -> None:
    watch = RestPrediction(DT)
    assert all(watch.see(min(-0.55 + 0.01 * k, 0.3)) is None for k in range(300))
