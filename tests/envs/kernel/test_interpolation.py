"""Each interpolation order: one polynomial, through the boundary values that it promises, with its own derivatives."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from airhockey.envs.kernel.interpolation import WHOLE_TRAJECTORY, interpolate

TIMES = 0.001 * np.arange(1, 21)
END = 0.02
PROMISES = {1: (1, 1), 2: (2, 1), 3: (2, 2), 4: (3, 2), 5: (3, 3)}  # order: derivatives met at the start, at the end


def interpolated(order, action, command, n):
    """Set-points, the command after the action, and the jerk."""
    after, set_points, jerk = command.copy(), np.full((20, 3, n), np.nan), np.full(n, np.nan)
    interpolate(order, np.ascontiguousarray(action, dtype=float), after, set_points, jerk)
    return set_points, after, jerk


def boundary_values(seed, n=4):
    random = np.random.default_rng(seed)
    scale = np.array([[0.05], [1.0], [10.0]])
    return random.normal(size=(3, n)) * scale + [[1.0], [0.0], [0.0]], random.normal(size=(3, n)) * scale


def fit(order, samples):
    """The polynomial of that degree nearest to the samples."""
    return Polynomial.fit(TIMES, samples, order, domain=[0.0, END])


@pytest.mark.parametrize("order", PROMISES)
@pytest.mark.parametrize("seed", range(5))
def test_it_is_one_polynomial_and_its_derivatives(order, seed):
    action, command = boundary_values(seed)
    set_points, _, _ = interpolated(order, action[: PROMISES[order][1]], command, 4)
    for joint in range(4):
        position = fit(order, set_points[:, 0, joint])
        for derivative, tolerance in ((0, 1e-12), (1, 1e-9), (2, 1e-6)):
            np.testing.assert_allclose(
                position.deriv(derivative)(TIMES),
                set_points[:, derivative, joint],
                atol=tolerance * max(1.0, np.abs(set_points[:, derivative]).max()),
            )


@pytest.mark.parametrize("order", PROMISES)
@pytest.mark.parametrize("seed", range(5))
def test_it_meets_the_boundary_values_that_it_promises(order, seed):
    action, command = boundary_values(seed)
    at_start, at_end = PROMISES[order]
    set_points, after, _ = interpolated(order, action[:at_end], command, 4)
    for joint in range(4):
        position = fit(order, set_points[:, 0, joint])
        values = [position, position.deriv(1), position.deriv(2)]
        for row in range(at_start):
            assert values[row](0.0) == pytest.approx(command[row, joint], abs=10.0 ** (3 * row - 10))
        for row in range(at_end):
            assert set_points[-1, row, joint] == pytest.approx(action[row, joint], abs=10.0 ** (3 * row - 12))
    np.testing.assert_array_equal(after, set_points[-1])  # the next previous command


@pytest.mark.parametrize("order", [3, 4, 5])
def test_the_jerk_is_the_slope_of_the_acceleration_plus_its_jump(order):
    action, command = boundary_values(7)
    set_points, _, jerk = interpolated(order, action[: PROMISES[order][1]], command, 4)
    for joint in range(4):
        acceleration = fit(order, set_points[:, 0, joint]).deriv(2).convert()
        slope, start = acceleration.coef[1], acceleration.coef[0]
        expected = abs(slope) + abs(start - command[2, joint]) / 0.001
        assert jerk[joint] == pytest.approx(expected, rel=1e-4, abs=0.1)


@pytest.mark.parametrize("order", [1, 2, -1])
def test_low_orders_report_an_infinite_jerk(order):
    action, command = boundary_values(8)
    assert np.all(np.isinf(interpolated(order, action[:2], command, 4)[2]))


def test_order_one_has_no_acceleration():
    action, command = boundary_values(9)
    set_points, _, _ = interpolated(1, action[:1], command, 4)
    assert np.all(set_points[:, 2] == 0.0)


def test_order_minus_one_leads_position_and_velocity_each_on_a_line():
    action, command = boundary_values(10)
    set_points, after, _ = interpolated(-1, action[:2], command, 4)
    share = (TIMES / END)[:, None]
    np.testing.assert_allclose(set_points[:, 0], command[0] + share * (action[0] - command[0]), atol=1e-12)
    np.testing.assert_allclose(set_points[:, 1], command[1] + share * (action[1] - command[1]), atol=1e-12)
    slope = np.broadcast_to((action[1] - command[1]) / END, (20, 4))
    np.testing.assert_allclose(set_points[:, 2], slope, rtol=1e-12)
    np.testing.assert_allclose(after, [action[0], action[1], slope[0]])
    velocity = (action[0] - command[0]) / END
    assert np.abs(set_points[:, 1] - velocity).max() > 0.1  # by design not the derivative of the position


@pytest.mark.parametrize(("size", "rests"), [(0.99e-3, True), (1.01e-3, False)])
def test_order_two_starts_from_rest_when_all_joints_together_hardly_move(size, rests):
    command = np.array([[0.3, -0.2], [1.0, -2.0], [0.0, 0.0]])
    step = size * np.array([0.6, 0.8])
    set_points, _, _ = interpolated(2, [command[0] + step], command, 2)
    starts = np.array([fit(2, set_points[:, 0, joint]).deriv()(0.0) for joint in range(2)])
    np.testing.assert_allclose(starts, [0.0, 0.0] if rests else command[1], atol=1e-9)
    np.testing.assert_allclose(set_points[-1, 0], command[0] + step, atol=1e-15)


def test_a_whole_trajectory_is_taken_as_it_is_and_leaves_the_command():
    command = np.arange(12.0).reshape(3, 4)
    action = np.random.default_rng(11).normal(size=(20, 3, 4))
    set_points, after, jerk = interpolated(WHOLE_TRAJECTORY, action.reshape(60, 4), command, 4)
    np.testing.assert_array_equal(set_points, action)
    np.testing.assert_array_equal(after, command)
    assert np.all(jerk == 0.0)
