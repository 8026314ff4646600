"""The defence: its planning against its definitions, and whole episodes."""

import numpy as np
import pytest
from skill_player import SkillPlayer

from airhockey.agents.control.cartesian import cubic
from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.estimation.motion import advance, puck_motion
from airhockey.agents.planner.contacts.interception import STEP, Reach, Way, best_meeting, effort, meeting, puck_path
from airhockey.agents.planner.skills.defend import Defend
from airhockey.agents.planner.skills.repel import Repel
from airhockey.agents.skill import Situation
from airhockey.agents.table import CONTACT, HOME
from airhockey.errors import ConfigurationError

CONSTANTS = puck_motion().constants
REACH = Reach(np.array([1.0, 2.0]), np.array([9.0, 18.0]), np.array([-0.92, -0.46]), np.array([0.0, 0.46]))


@pytest.fixture(scope="module")
def iiwa():
    return SkillPlayer("7dof-defend", Defend)


@pytest.fixture(scope="module")
def planar():
    return SkillPlayer("3dof-defend", Defend)


@pytest.fixture(scope="module")
def wish(iiwa):
    return iiwa.skill._wish


def test_effort_is_the_largest_need_along_the_cubic():
    random = np.random.default_rng(1)
    for _ in range(30):
        start, end = random.uniform(-0.3, 0.3, (2, 2))
        end_velocity = random.uniform(-1, 1, 2)
        duration = random.uniform(0.2, 0.8)
        path = cubic(start, np.zeros(2), end, end_velocity, duration)
        times = np.linspace(0.0, duration, 2001)
        speeds = np.array([path.at(t)[1] for t in times])
        accelerations = np.gradient(speeds, times, axis=0)
        need = np.maximum(
            np.abs(accelerations).max(axis=0) / REACH.acceleration, np.abs(speeds).max(axis=0) / REACH.speed
        )
        assert effort(Way(start, np.zeros(2), end, end_velocity, duration), REACH) == pytest.approx(
            np.hypot(*need), rel=0.02
        )


def test_a_path_ends_at_the_goal(wish):
    path, bounces, _ = puck_path(np.array([-0.5, 0.0, -2.0, 0.0, 0.0]), 150, wish.mouth, CONSTANTS)
    assert path[-1, 0] > -1.0 and bounces[-1] == 0
    path, bounces, since = puck_path(np.array([-0.5, 0.4, -2.0, 0.0, 0.0]), 100, wish.mouth, CONSTANTS)
    assert len(path) == 101 and bounces[-1] >= 1 and since[-1] < 1.0


def test_a_meeting_is_on_the_path_on_the_table_and_in_the_pucks_way(wish):
    for y in (-0.3, 0.0, 0.2):
        watched = puck_path(np.array([0.4, y, -2.0, 0.1, 0.0]), 150, wish.mouth, CONSTANTS)
        path = watched.states
        index, _, need = best_meeting(watched, HOME, np.zeros(2), REACH, wish, -10)
        place, velocity = meeting(path[index], wish)
        assert index * STEP > 0.2 and need < 2.0
        assert np.hypot(*(place - path[index, :2])) == pytest.approx(CONTACT)
        assert (place - path[index, :2]) @ path[index, 2:4] > 0.0
        assert np.all(place >= REACH.lower) and np.all(place <= REACH.upper)
        assert 0.0 < np.hypot(*velocity) < np.hypot(*path[index, 2:4])  # it yields


def test_nothing_is_met_where_the_mallet_may_not_be(wish):
    nowhere = REACH._replace(lower=np.array([-0.2, 0.0]), upper=np.array([-0.19, 0.01]))
    path = puck_path(np.array([0.4, 0.3, -2.0, 0.0, 0.0]), 100, wish.mouth, CONSTANTS)
    assert best_meeting(path, HOME, np.zeros(2), nowhere, wish, -10)[0] == -1


@pytest.mark.parametrize("robot", ["iiwa", "planar"])
def test_it_defends(robot, request):
    player = request.getfixturevalue(robot)
    results = [player.play(seed) for seed in range(100, 115)]
    assert sum(info["success"] for info, _, _ in results) >= 13
    assert not any(violated for _, violated, _ in results)


def test_it_defends_under_disturbances():
    player = SkillPlayer("7dof-defend", Defend, "server")
    results = [player.play(seed) for seed in range(10)]
    assert sum(info["success"] for info, _, _ in results) >= 8
    assert not any(violated for _, violated, _ in results)


def test_an_episode_is_reproducible(iiwa):
    np.testing.assert_array_equal(iiwa.play(3)[2], iiwa.play(3)[2])


def test_repel_sends_the_puck_back():
    player = SkillPlayer("7dof-defend", Repel)
    pucks = np.array([player.play(seed)[2] for seed in range(10)])
    assert np.sum((pucks[:, 0] > 0.0) & (pucks[:, 3] > 0.3)) >= 9


def test_a_parameter_file_that_does_not_fit_is_named(iiwa, tmp_path):
    path = tmp_path / "odd.yaml"
    path.write_text("horizon: soon\n")
    with pytest.raises(ConfigurationError, match=r"odd\.yaml"):
        Defend(iiwa.env.env_info, path)
    with pytest.raises(ConfigurationError, match="nowhere"):
        Defend(iiwa.env.env_info, "nowhere")


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_way_to_the_guard_goes_round_a_slow_puck(iiwa, side):
    """Straight on, this mallet would knock the puck, which rolls beside our goal, into it."""
    puck, tip, velocity = (
        np.array([-0.88, 0.21 * side, -0.15, -0.14 * side, 0.0]),
        np.array([-0.90, 0.34 * side]),
        np.zeros(2),
    )
    gaps = []
    for step in range(60):
        estimate = PuckEstimate(puck.copy(), 1e-6 * np.eye(5), 0)
        now = Situation(estimate, tip, velocity, None, 0.02, step, lambda *state: np.array(state))
        tip, velocity = iiwa.skill._guard(now)
        advance(puck, 0.02, CONSTANTS)
        gaps.append(np.hypot(*(puck[:2] - tip)) - CONTACT)
    assert min(gaps) > 0.0
    assert np.hypot(*(tip - [-0.84, 0.0])) < 0.25  # and it gets there
