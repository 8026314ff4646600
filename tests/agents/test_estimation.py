"""The puck's motion, filter and prediction against the simulator, whose true state they must match."""

import pathlib

import numpy as np
import pytest
from sources import load_script

from airhockey import envs
from airhockey.agents.estimation.kalman import PuckFilter
from airhockey.agents.estimation.motion import advance, bounce, puck_motion, transition
from airhockey.agents.estimation.prediction import PuckPredictor
from airhockey.envs.specs import PUCK, TABLE

CONSTANTS = puck_motion().constants
SIDE = TABLE.width / 2 - PUCK.radius


@pytest.fixture(scope="module")
def quiet():
    """An environment whose robot stands still far from the puck."""
    return envs.make("7dof-prepare")


def fly(env, state, steps):
    """The simulator's states (x, y, ẋ, ẏ, yaw rate) of a puck let loose."""
    base = env.base_observation
    base[:6] = [state[0], state[1], 0.0, state[2], state[3], state[4]]
    env.reset(state=base)
    joints = env.base_observation[6:13]
    states = [np.asarray(state, dtype=float)]
    for _ in range(steps):
        env.step(np.stack([joints, np.zeros(7)]))
        states.append(env.base_observation[[0, 1, 3, 4, 5]])
    return np.array(states)


def test_free_flight_is_the_simulators(quiet):
    start = np.array([0.4, -0.1, -0.9, 0.4, 6.0])
    true = fly(quiet, start, 30)
    state = start.copy()
    for k in range(1, 31):
        assert advance(state, 0.02, CONSTANTS) == 0
        np.testing.assert_allclose(state[:4], true[k, :4], atol=1e-3)
        assert state[4] == pytest.approx(true[k, 4], abs=0.05)


@pytest.mark.parametrize(("speed", "spin"), [(0.6, 0.0), (1.2, 8.0), (2.0, -8.0)])
def test_a_bounce_is_the_simulators_but_for_the_chance_in_its_restitution(quiet, speed, spin):
    start = np.array([0.4, 0.25, 0.5 * speed, speed, spin])
    true = fly(quiet, start, 40)
    turned = int(np.flatnonzero(true[:, 3] < 0)[0]) + 3
    state = start.copy()
    assert advance(state, 0.02 * turned, CONSTANTS) == 1
    np.testing.assert_allclose(state[2], true[turned, 2], atol=0.03 * speed)  # the tangential part is exact
    np.testing.assert_allclose(state[4], true[turned, 4], atol=0.5)
    np.testing.assert_allclose(state[3], true[turned, 3], atol=0.3 * speed)  # e scatters from 0.70 to 0.97


def test_the_constants_are_what_the_script_identifies(quiet):
    script = load_script(pathlib.Path(__file__).parents[2], "identify_bounces")
    found = script.identify(quiet, bounces=60, seed=1)
    assert found["restitution"] == pytest.approx(puck_motion().restitution, abs=0.03)
    assert found["slip_impulse"] == pytest.approx(puck_motion().slip_impulse, abs=0.003)
    assert found["rim_give"] == pytest.approx(puck_motion().rim_give, abs=0.001)


def test_a_bounce_conserves_what_the_impulse_cannot_change():
    """The tangential impulse acts at the rim: the angular momentum about the point of contact stays."""
    rng = np.random.default_rng(1)
    for _ in range(20):
        state = np.array([0.1, SIDE + 0.01, *rng.normal(size=2), 10 * rng.normal()])
        state[3] = abs(state[3])
        before = state.copy()
        assert bounce(state, CONSTANTS)
        assert state[3] == pytest.approx(-puck_motion().restitution * before[3])

        def momentum(s):
            return s[2] * PUCK.radius + 0.5 * PUCK.radius**2 * s[4]  # of a uniform disc, by mass

        assert momentum(state) == pytest.approx(momentum(before))


def test_the_mouth_of_the_goal_does_not_reflect():
    inside = np.array([TABLE.length / 2 - PUCK.radius + 0.01, 0.05, 1.0, 0.0, 0.0])
    beside = np.array([TABLE.length / 2 - PUCK.radius + 0.01, 0.3, 1.0, 0.0, 0.0])
    assert not bounce(inside, CONSTANTS)
    assert bounce(beside, CONSTANTS) and beside[2] < 0


def test_the_transitions_derivative_is_that_of_the_motion():
    for state in ([0.2, 0.1, -1.0, 0.5, 3.0], [0.2, SIDE - 0.005, -1.0, 1.5, 3.0]):
        state = np.array(state)
        after, jacobian, _ = transition(state, 0.02, CONSTANTS)
        for j in range(5):
            moved = state.copy()
            moved[j] += 1e-5
            advance(moved, 0.02, CONSTANTS)
            np.testing.assert_allclose((moved - after) / 1e-5, jacobian[:, j], atol=1e-2)


def observe(filter_, state, rng, sigma=(0.002, 0.05, 0.5)):
    noise = rng.normal(size=5) * [sigma[0], sigma[0], sigma[1], sigma[1], sigma[2]]
    seen = state + noise
    return filter_.update(seen[:2], seen[2:]), seen


def test_the_filter_is_better_than_the_observations_and_knows_how_good_it_is(quiet):
    rng, filter_ = np.random.default_rng(2), PuckFilter()
    errors, squares = [], []
    for _ in range(8):
        filter_.reset()
        true = fly(quiet, [0.6, rng.uniform(-0.2, 0.2), -rng.uniform(0.5, 1.5), 0.1, 0.0], 30)
        for k, state in enumerate(true):
            estimate, _ = observe(filter_, state, rng)
            if k > 15:
                error = estimate.state - state
                errors.append(error)
                squares.append(error @ np.linalg.solve(estimate.covariance, error))
    spread = np.std(errors, axis=0)
    assert np.all(spread[:2] < 0.0015) and np.all(spread[2:4] < 0.02)
    assert 1.0 < np.mean(squares) < 12.0  # χ² with 5 degrees of freedom has mean 5


@pytest.mark.sampled(2)
@pytest.mark.parametrize("lost_shows", ["hold", "zero"])
def test_a_lost_track_is_ridden_out(lost_shows):
    rng, filter_ = np.random.default_rng(3), PuckFilter()
    state, seen = np.array([0.5, 0.0, -1.0, 0.2, 0.0]), None
    for k in range(30):
        if 15 <= k < 20:
            shown = seen if lost_shows == "hold" else np.array([*seen[:2], 0.0, 0.0, 0.0])
            estimate = filter_.update(shown[:2], shown[2:])
            assert estimate.lost == k - 14
        else:
            estimate, seen = observe(filter_, state, rng)
            assert estimate.lost == 0
        if k > 10:
            np.testing.assert_allclose(estimate.state[:2], state[:2], atol=0.006)
            np.testing.assert_allclose(estimate.state[2:4], state[2:4], atol=0.08)
        advance(state, 0.02, CONSTANTS)


def test_a_puck_that_really_lies_still_is_believed():
    filter_ = PuckFilter()
    for _ in range(40):
        estimate = filter_.update(np.array([0.1, 0.2, 0.0]), np.zeros(3))
    np.testing.assert_allclose(estimate.state, [0.1, 0.2, 0.0, 0.0, 0.0], atol=1e-6)


def test_a_hit_is_noticed_within_two_observations():
    rng, filter_ = np.random.default_rng(4), PuckFilter()
    state = np.array([-0.4, 0.1, 0.0, 0.0, 0.0])
    for _ in range(20):
        observe(filter_, state, rng)
    state[2] = 1.5
    for _ in range(2):
        advance(state, 0.02, CONSTANTS)
        estimate, _ = observe(filter_, state, rng)
    assert estimate.state[2] == pytest.approx(1.5, abs=0.1)


def test_the_prediction_is_where_the_simulator_puts_the_puck(quiet):
    predictor, filter_ = PuckPredictor(), PuckFilter()
    true = fly(quiet, [0.5, 0.1, -1.5, 0.2, 5.0], 60)
    for state in true[:3]:
        estimate = filter_.update(state[:2], state[2:])
    state, _ = predictor.at_time(estimate, 0.8)
    np.testing.assert_allclose(state[:4], true[42, :4], atol=5e-3)
    crossing = predictor.at_line(estimate, -0.3, 2.0)
    step = crossing.time / 0.02 + 2
    k = int(step)
    between = true[k] + (step - k) * (true[k + 1] - true[k])
    np.testing.assert_allclose(crossing.state[:2], between[:2], atol=5e-3)
    assert crossing.state[0] == pytest.approx(-0.3)
    path = predictor.path(estimate, 0.8)
    np.testing.assert_allclose(path[-1], state)


def test_the_predictions_covariance_is_that_of_many_flights():
    """Monte Carlo over the estimate's uncertainty, without bounces."""
    rng, predictor = np.random.default_rng(5), PuckPredictor(drift_velocity=0.0)
    filter_ = PuckFilter()
    estimate = filter_.update(np.array([0.3, 0.0]), np.array([-1.0, 0.1, 0.0]))
    mean, covariance = predictor.at_time(estimate, 0.5)
    flights = rng.multivariate_normal(estimate.state, estimate.covariance, size=4000)
    for flight in flights:
        advance(flight, 0.5, CONSTANTS)
    np.testing.assert_allclose(flights.mean(axis=0)[:4], mean[:4], atol=3e-3)
    np.testing.assert_allclose(np.sqrt(np.diag(covariance))[:4], flights.std(axis=0)[:4], rtol=0.06)


def test_a_puck_that_goes_the_other_way_or_rests_never_crosses():
    predictor, filter_ = PuckPredictor(), PuckFilter()
    assert predictor.at_line(filter_.update(np.array([-0.2, 0.0]), np.zeros(3)), -0.5, 1.0) is None
    filter_.reset()
    assert predictor.at_line(filter_.update(np.array([-0.2, 0.0]), np.array([0.5, 0.0, 0.0])), -0.5, 0.5) is None
