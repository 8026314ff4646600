"""What single policies do: where they lead the end-effector, and when they say that they are done."""

import numpy as np
import pytest

from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.skill import Situation
from airhockey.agents.table import CONTACT, HOME
from airhockey.agents.thesis.defend import DefendPolicy
from airhockey.agents.thesis.hit import HitPolicy
from airhockey.agents.thesis.home import HomePolicy
from airhockey.agents.thesis.opponent import OpponentWatch
from airhockey.agents.thesis.parameters import thesis_parameters
from airhockey.agents.thesis.prepare import PreparePolicy

DT = 0.02
BOTH = pytest.mark.parametrize("parameters", [thesis_parameters("tuned"), thesis_parameters("thesis")])


def view(puck, tip, tip_velocity=(0.0, 0.0)):
    estimate = PuckEstimate(np.array([*puck, *np.zeros(5 - len(puck))]), 1e-6 * np.eye(5), 0)
    return Situation(estimate, np.array(tip, dtype=float), np.array(tip_velocity, dtype=float), None, DT)


def follow(policy, puck, tip, steps, until=None):
    """Let an end-effector that does as it is told follow a policy; the puck lies still. Positions (k, 2) and phases."""
    tip, velocity, tips, phases = np.array(tip, dtype=float), np.zeros(2), [], []
    for _ in range(steps):
        move = policy.step(view(puck, tip, velocity))
        velocity, tip = (move.target - tip) / DT, move.target
        tips.append(tip)
        phases.append(policy.phase)
        if move.finished or policy.phase == until:
            break
    return np.array(tips), phases


@BOTH
@pytest.mark.parametrize("y", [-0.45, 0.45])
def test_prepare_goes_round_the_puck_to_the_inside_and_pushes(parameters, y):
    policy = PreparePolicy(parameters.prepare)
    puck = np.array([-0.5, y])
    tips, phases = follow(policy, puck, HOME, 600, until="retreat")
    assert list(dict.fromkeys(phases)) == ["adjustment", "acceleration", "retreat"]
    distances = np.hypot(*(tips - puck).T)
    assert distances[-1] == pytest.approx(CONTACT, abs=0.01)
    before = np.array([phase == "adjustment" for phase in phases])
    assert distances[before].min() > CONTACT + 0.01  # the puck is not touched on the way round
    assert abs(tips[-1][0] - puck[0]) < 0.03 and abs(tips[-1][1]) < abs(y)  # from the middle of the table


@BOTH
def test_prepare_has_nothing_to_do_where_there_is_space(parameters):
    assert PreparePolicy(parameters.prepare).step(view((-0.5, 0.0), HOME)).finished


@BOTH
@pytest.mark.parametrize("puck", [(-0.5, 0.2), (-0.4, -0.3)])
def test_hit_comes_from_behind_on_the_line_to_the_goal(parameters, puck):
    policy = HitPolicy(parameters.hit, OpponentWatch(3.0, DT))
    puck = np.array(puck)
    tips, phases = follow(policy, puck, HOME, 800, until="slow-down")
    assert phases[-1] == "slow-down" and "acceleration" in phases
    near = np.flatnonzero(np.hypot(*(tips - puck).T) < CONTACT)[0]
    way, goal = puck - tips[near], np.array([0.974, 0.0]) - puck
    cosine = way @ goal / np.linalg.norm(way) / np.linalg.norm(goal)
    assert cosine > np.cos(np.radians(6.0))
    speed = np.hypot(*np.diff(tips[near - 1 : near + 1], axis=0)[0]) / DT
    assert speed > 0.8


@BOTH
def test_hit_does_not_begin_without_space_nor_beyond_the_middle(parameters):
    policy = HitPolicy(parameters.hit, OpponentWatch(3.0, DT))
    assert policy.step(view((-0.5, 0.45), HOME)).finished
    assert policy.step(view((0.1, 0.0), HOME)).finished


@BOTH
def test_hit_waits_for_a_moving_puck(parameters):
    policy = HitPolicy(parameters.hit, OpponentWatch(3.0, DT))
    policy.step(view((-0.5, 0.0, 0.05, 1.5 * parameters.hit.wait_speed), HOME))
    assert policy.phase == "wait"


def test_defend_meets_the_puck_on_the_line_moving_with_it():
    parameters = thesis_parameters("tuned").defend
    policy = DefendPolicy(parameters)
    state, tip, velocity = np.array([0.5, 0.1, -1.5, -0.2, 0.0]), np.array(HOME), np.zeros(2)
    for _ in range(100):
        move = policy.step(view(state, tip, velocity))
        if move.finished:
            break
        velocity, tip = (move.target - tip) / DT, move.target
        state = state + DT * np.array([state[2], state[3], -0.5 * state[2], -0.5 * state[3], 0.0])
        if np.hypot(*(state[:2] - tip)) < CONTACT:
            break
    assert policy.phase == "cushion"
    assert tip[0] == pytest.approx(parameters.defend_line, abs=0.01)
    way = tip - state[:2]
    assert way @ state[2:4] > 0.999 * np.linalg.norm(way) * np.linalg.norm(state[2:4])  # head on
    np.testing.assert_allclose(velocity, parameters.cushion * state[2:4], atol=0.1)


@BOTH
@pytest.mark.parametrize("state", [(0.3, 0.0, -0.1, 0.0), (-0.3, 0.0, 1.0, 0.0), (-0.9, 0.1, -1.0, 0.0)])
def test_there_is_nothing_to_defend_against_a_slow_a_leaving_or_a_passed_puck(parameters, state):
    assert DefendPolicy(parameters.defend).step(view(state, HOME)).finished


@BOTH
@pytest.mark.parametrize("start", [(-0.5, 0.3), (-0.4, -0.35), (-0.86, 0.4), (-0.7, 0.0)])
def test_home_is_reached_and_kept(parameters, start):
    policy = HomePolicy(parameters.home, parameters.hit.theta)
    tips, phases = follow(policy, (0.5, 0.0), start, 600)
    assert phases[-1] == "arrived"
    assert np.hypot(*(tips[-1] - HOME)) < parameters.home.arrived
    assert tips[:, 0].min() > -0.92 and np.abs(tips[:, 1]).max() < 0.46


@BOTH
def test_the_way_home_keeps_clear_of_the_puck(parameters):
    policy = HomePolicy(parameters.home, parameters.hit.theta)
    puck = np.array([-0.7, 0.005])
    tips, phases = follow(policy, puck, (-0.45, 0.0), 900)
    assert phases[-1] == "arrived"
    assert np.hypot(*(tips - puck).T).min() > CONTACT


def test_an_opponent_that_repeats_itself_is_foreseen_and_another_one_is_not():
    rng, repeating, wandering = np.random.default_rng(1), OpponentWatch(3.0, DT), OpponentWatch(3.0, DT)

    def eight(t):
        return np.array([0.86 - 0.1 * np.sin(3 * t) * np.cos(3 * t), -0.16 * np.cos(3 * t)])

    assert repeating.predict(0.5) is None
    place = np.array([0.8, 0.0])
    for k in range(80):
        repeating.see(eight(k * DT) + rng.normal(0.0, 0.005, 2))
        place = place + rng.normal(0.0, 0.04, 2)
        wandering.see(place)
    assert repeating.ready
    for ahead in (0.0, 0.5, 1.0):
        np.testing.assert_allclose(repeating.predict(ahead), eight(79 * DT + ahead), atol=0.02)
    np.testing.assert_allclose(wandering.predict(1.0), wandering.predict(0.0))


def pushes(parameters, cycles=3):
    """Least distance of the end-effector to a puck that nothing moves, for one push after the other."""
    policy = PreparePolicy(parameters.prepare)
    puck, tip, least = np.array([-0.5, -0.46]), np.array(HOME), []
    for _ in range(cycles):
        policy.start()
        tips, phases = follow(policy, puck, tip, 600)
        tip = tips[-1]
        least.append(min(np.hypot(*(tips - puck).T)[np.array(phases) == "acceleration"]))
    return least


def test_a_push_in_vain_is_followed_by_a_deeper_one():
    first, second, third = pushes(thesis_parameters("tuned"))
    deeper = thesis_parameters("tuned").prepare.deeper
    assert first - second == pytest.approx(deeper, abs=0.004)  # a step's length
    assert first - third == pytest.approx(2.0 * deeper, abs=0.004)


def test_the_text_never_pushes_deeper():
    parameters = thesis_parameters("thesis")
    deepest = CONTACT + parameters.prepare.touch - parameters.prepare.theta[2]  # within a step of the touch
    assert min(pushes(parameters, cycles=5)) > deepest


def test_another_serve_forgets_the_pushes_in_vain():
    policy = PreparePolicy(thesis_parameters("tuned").prepare)
    puck = np.array([-0.5, -0.46])
    for reset in (False, True):
        policy.start()
        follow(policy, puck, HOME, 600)
        if reset:
            policy.reset()
        policy.start()
        tips, _ = follow(policy, puck, HOME, 600, until="retreat")
        distance = np.hypot(*(tips[-1] - puck))
        assert (distance < CONTACT - 0.008) != reset


def steps_before_the_push(parameters):
    """For an end-effector that cannot move on, beside a puck at the short rim."""
    policy = PreparePolicy(parameters.prepare)
    for step in range(120):
        policy.step(view((-0.927, 0.148), (-0.92, 0.038)))
        if policy.phase == "acceleration":
            return step
    return None


def test_an_end_effector_that_is_stuck_pushes_from_where_it_is():
    tuned = thesis_parameters("tuned")
    assert steps_before_the_push(tuned) == pytest.approx(tuned.prepare.stuck, abs=2)
    assert steps_before_the_push(thesis_parameters("thesis")) is None


@pytest.mark.parametrize(("puck", "hard"), [((-0.85, -0.3), True), ((-0.85, -0.1), False), ((-0.5, -0.46), False)])
def test_only_a_push_at_the_short_rim_is_a_hard_one(puck, hard):
    """From there the puck must come a long way; at the side rim it would run too far, past the own goal it could go in."""
    parameters = thesis_parameters("tuned").prepare
    tips, phases = follow(PreparePolicy(parameters), np.array(puck), HOME, 600, until="retreat")
    steps = np.hypot(*np.diff(tips, axis=0).T)[np.array(phases[1:]) == "acceleration"]
    assert np.median(steps) == pytest.approx(parameters.end_push if hard else parameters.theta[2], rel=0.05)
