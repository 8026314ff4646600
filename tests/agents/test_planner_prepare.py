"""Preparing: pushes by finite differences, the search by trying out what it finds, the way round the puck, whole episodes."""

import numpy as np
import pytest
from skill_player import SkillPlayer

from airhockey.agents.estimation.motion import puck_motion
from airhockey.agents.planner.estimation.rest_detection import RestDetection
from airhockey.agents.planner.motion.driving import is_clear, round_the_puck
from airhockey.agents.planner.pushes.push import (
    END,
    FOLLOW,
    LENGTH,
    PLACE,
    RETREAT,
    RUN_UP,
    START,
    VELOCITY,
    coast,
    mallet_at,
    possible,
    puck_after,
)
from airhockey.agents.planner.pushes.push_search import Found, draw, search, worth
from airhockey.agents.planner.skills.prepare import Prepare
from airhockey.agents.table import CONTACT

CONSTANTS = puck_motion().constants
FAST = np.array([9.0, 9.0]), np.array([99.0, 99.0])


@pytest.fixture(scope="module")
def player():
    return SkillPlayer("7dof-prepare", Prepare)


@pytest.fixture(scope="module")
def goal(player):
    return player.skill._goal


def pushes(goal, count=20):
    random = np.random.default_rng(5)
    return [draw(np.array([-0.6, 0.43, 0.0, 0.0, 0.0]), goal, random) for _ in range(count)]


def test_velocity_is_the_derivative_of_the_position(goal):
    for push in pushes(goal):
        for time in np.linspace(-push[RUN_UP] + 0.01, push[FOLLOW] + push[RETREAT] - 0.01, 23):
            if min(abs(time), abs(time - push[FOLLOW])) < 1e-4:
                continue
            for axis in range(2):
                slope = (mallet_at(push, axis, time + 1e-6)[0] - mallet_at(push, axis, time - 1e-6)[0]) / 2e-6
                assert mallet_at(push, axis, time)[1] == pytest.approx(slope, abs=1e-5)


def test_a_stroke_goes_from_rest_through_the_contact_to_rest(goal):
    for push in pushes(goal):
        for time, part, velocity in (
            (-push[RUN_UP], START, np.zeros(2)),
            (0.0, PLACE, push[VELOCITY : VELOCITY + 2]),
            (push[FOLLOW] + push[RETREAT], END, np.zeros(2)),
        ):
            for axis in range(2):
                state = mallet_at(push, axis, time)
                np.testing.assert_allclose(state, (push[part + axis], velocity[axis]), atol=1e-9)


def test_what_is_possible_stays_on_the_table_and_within_the_means(goal):
    for push in pushes(goal, 60):
        path = np.array(
            [
                [mallet_at(push, axis, t) for axis in range(2)]
                for t in np.arange(-push[RUN_UP], push[FOLLOW] + push[RETREAT], 0.02)
            ]
        )
        inside = np.all(path[:, :, 0] >= goal.lower) and np.all(path[:, :, 0] <= goal.upper)
        slow = np.all(np.abs(path[:, :, 1]) <= goal.speed)
        if possible(push, goal.lower, goal.upper, goal.speed, goal.acceleration):
            assert inside and slow
        if not inside:
            assert not possible(push, goal.lower, goal.upper, *FAST)


@pytest.mark.parametrize("place", [(-0.5, 0.42), (-0.3, -0.44), (-0.88, 0.2), (-0.9, -0.4), (-0.92, 0.47)])
def test_the_stroke_found_brings_the_puck_to_a_good_place(goal, place):
    puck = np.array([*place, 0.0, 0.0, 0.0])
    push, value, _ = search(puck, Found(np.zeros(LENGTH), -2.0), goal, CONSTANTS, np.random.default_rng(2), 600, 10**6)
    after, out_of_turn = puck_after(puck, push, CONSTANTS, goal.friction, 1.0, goal.middle)
    ended, last = coast(after, CONSTANTS, goal.middle, goal.horizon)
    assert not out_of_turn and value > 1.3 and ended in (0, 1)
    assert -0.8 < last[0] <= -0.2 and abs(last[1]) < 0.39105 and last[2] < 0.1


def test_a_search_in_pieces_of_bounded_effort_finds_the_same(goal):
    """What a control step spends is bounded, and the push does not depend on where the pieces end."""
    puck, rng = np.array([-0.94, -0.48, 0.0, 0.0, 0.0]), np.random.default_rng(2)
    nothing = Found(np.zeros(LENGTH), -2.0)
    found, pieces = nothing, 0
    while found.tried < 60:
        before = found.tried
        found = search(puck, found, goal, CONSTANTS, rng, 60 - before, 5)
        pieces += 1
        assert found.tried > before
    at_once = search(puck, nothing, goal, CONSTANTS, np.random.default_rng(2), 60, 10**6)
    assert pieces > 2
    np.testing.assert_array_equal(found.push, at_once.push)


def test_worth_follows_the_rules_of_the_task(goal):
    def of(ended, x, y, vx=0.0):
        return worth(ended, np.array([x, y, vx, 0.0, 0.0]), goal)

    assert of(2, -0.5, 0.2) == -1.0  # over the middle line, or in the goal
    assert (
        of(1, -0.9, 0.01) == -1.0 and of(1, -0.5, 0.01, 0.2) == -1.0
    )  # to the long axis where, or faster than, it may not
    assert of(1, -0.5, 0.01) > of(0, -0.5, 0.2) > 1.0  # done now, rather than at the end of the time
    assert 1.0 > of(0, -0.5, 0.4) > of(0, -0.5, 0.48) > 0.0


def test_the_way_round_never_touches_the_puck():
    lower, upper = np.array([-0.92, -0.46]), np.array([-0.1, 0.46])
    random = np.random.default_rng(8)
    for _ in range(60):
        puck = random.uniform([-0.8, -0.4], [-0.3, 0.4])
        tip, place = (random.uniform(lower, upper) for _ in range(2))
        if min(np.hypot(*(tip - puck)), np.hypot(*(place - puck))) < CONTACT + 0.02:
            continue
        for _ in range(400):
            way = round_the_puck(tip, place, puck, lower, upper, 0.012) - tip
            tip = tip + way * min(1.0, 0.01 / max(np.hypot(*way), 1e-9))
            assert np.hypot(*(tip - puck)) > CONTACT
            if np.hypot(*(tip - place)) < 1e-6:
                break
        assert np.hypot(*(tip - place)) < 1e-6


def test_a_way_is_clear_or_not():
    a, b = np.array([-0.6, 0.0]), np.array([-0.4, 0.0])
    assert is_clear(a, b, np.array([-0.5, 0.11]), 0.1)
    assert not is_clear(a, b, np.array([-0.5, 0.09]), 0.1)
    assert is_clear(a, a, np.array([-0.3, 0.0]), 0.1)


def test_a_slow_puck_is_told_from_a_resting_one():
    random = np.random.default_rng(3)
    for velocity in (np.zeros(2), np.array([0.03, -0.02])):
        watch = RestDetection(0.02)
        for k in range(60):
            watch.see(np.array([-0.5, 0.4]) + 0.02 * k * velocity + 0.0007 * random.standard_normal(2))
        position, seen = watch.motion()
        np.testing.assert_allclose(seen, velocity, atol=0.002)
        np.testing.assert_allclose(position, np.array([-0.5, 0.4]) + 0.02 * 59 * velocity, atol=0.001)
        np.testing.assert_allclose(watch.after(1e9), position + 2.0 * seen, atol=1e-9)


def test_it_prepares(player):
    results = [player.play(seed) for seed in range(300, 310)]
    assert sum(info["success"] for info, _, _ in results) >= 9
    assert not any(violated for _, violated, _ in results)


def test_an_episode_is_reproducible(player):
    np.testing.assert_array_equal(player.play(300)[2], player.play(300)[2])
