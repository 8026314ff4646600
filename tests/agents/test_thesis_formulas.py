"""The thesis's printed formulas against cases worked out by hand."""

import numpy as np
import pytest

from airhockey.agents.table import CONTACT
from airhockey.agents.thesis import defend, hit, home, prepare
from airhockey.agents.thesis.bank_shot import bank_aim
from airhockey.agents.thesis.polar import Polar, cartesian, direction_angle, limited_step, polar, wrapped
from airhockey.agents.thesis.policy import enough_space
from airhockey.envs.specs import MALLET

DT = 0.02


def test_polar_coordinates_by_hand():
    puck = np.array([0.1, 0.2])
    assert polar(puck, np.array([0.1, 0.5])) == Polar(pytest.approx(90.0), pytest.approx(0.3))
    assert polar(puck, np.array([-0.3, 0.2])) == Polar(pytest.approx(180.0), pytest.approx(0.4))
    assert polar(puck, np.array([0.1, -0.1]), gamma=30.0).beta == pytest.approx(240.0)
    assert direction_angle(np.zeros(2), np.array([1.0, -1.0])) == pytest.approx(-45.0)
    assert wrapped(350.0) == pytest.approx(-10.0) and wrapped(-190.0) == pytest.approx(170.0)


def test_cartesian_undoes_polar():
    rng = np.random.default_rng(1)
    for _ in range(20):
        center, point, gamma = rng.normal(size=2), rng.normal(size=2), rng.uniform(-180, 180)
        np.testing.assert_allclose(cartesian(center, polar(center, point, gamma), gamma), point, atol=1e-12)


def test_a_limited_step_goes_the_same_way():
    step = limited_step(np.zeros(2), np.array([3.0, 4.0]), 0.5)
    np.testing.assert_allclose(step, [0.3, 0.4])
    np.testing.assert_allclose(limited_step(np.zeros(2), np.array([0.03, 0.04]), 0.5), [0.03, 0.04])


THETA_HIT = (0.01, 0.03, 3e-4, 9e-5)


@pytest.mark.parametrize(
    ("beta", "y_puck", "expected"), [(150.0, -0.1, 30.0), (200.0, -0.1, -20.0), (210.0, 0.1, 30.0), (180.0, 0.0, 0.0)]
)
def test_hit_correction(beta, y_puck, expected):
    assert hit.correction(beta, y_puck) == pytest.approx(expected)


def test_hit_d_beta():
    # adjustment, step 50 (1 s): (0.01 + 0.03 · 1) · 30 = 1.2; acceleration: 30 / 2; slow-down: (0.01 + 0.03 · 0.02) · 30
    assert hit.d_beta(THETA_HIT, "adjustment", 50, DT, 30.0) == pytest.approx(1.2)
    assert hit.d_beta(THETA_HIT, "acceleration", 50, DT, 30.0) == pytest.approx(15.0)
    assert hit.d_beta(THETA_HIT, "slow-down", 50, DT, 30.0) == pytest.approx(0.318)


def test_hit_d_s():
    # acceleration, step 10: (0.001 + 9e-5 · 10 · 0.02) / (0.15185 + 0.04815) = 0.001018 / 0.2 = 0.00509
    assert hit.d_s(THETA_HIT, "adjustment", 10, DT, 0.001, 0.3) == pytest.approx(3e-4)
    assert hit.d_s(THETA_HIT, "acceleration", 10, DT, 0.001, 0.2 - MALLET.radius) == pytest.approx(0.00509)
    assert hit.d_s(THETA_HIT, "slow-down", 10, DT, 0.001, 0.3) == pytest.approx(0.001)


@pytest.mark.parametrize(("x", "gamma", "room"), [(-0.7, 0.0, 0.21385), (-0.2, 90.0, 0.45885)])
def test_room_behind_the_puck(x, gamma, room):
    # along x: 0.974 − 0.04815 − 0.012 − 0.7; along y: 0.519 − 0.04815 − 0.012
    assert hit.room_behind(np.array([x, 0.0]), gamma) == pytest.approx(room, abs=1e-6)


def test_defend_target():
    # θ0 (r_puck + r_mallet) ‖v‖ / 2 = 0.5 · 0.0798 · 2 / 2 = 0.0399
    theta = (0.5, 0.0, 0.1, 0.0, 0.2)
    assert pytest.approx(0.0798) == CONTACT
    assert defend.y_target(theta, 0.1, 2.0, from_top=True) == pytest.approx(0.1399)
    assert defend.y_target(theta, 0.1, 2.0, from_top=False) == pytest.approx(0.0601)


def test_defend_deltas():
    # δx = 0.01 + 0.1 · 2 · (−0.8 + 0.86) = 0.022;  δy = −0.02 + 0.2 · 2 · (0.1 − 0) = 0.02
    theta = (0.5, 0.01, 0.1, -0.02, 0.2)
    step = defend.deltas(theta, 2.0, np.array([-0.8, 0.1]), np.array([-0.86, 0.0]))
    np.testing.assert_allclose(step, [0.022, 0.02])


@pytest.mark.parametrize(("beta", "y_puck", "expected"), [(130.0, -0.4, 40.0), (230.0, 0.4, 40.0), (60.0, 0.0, -30.0)])
def test_prepare_correction_as_printed(beta, y_puck, expected):
    assert prepare.correction(beta, y_puck) == pytest.approx(expected)


def test_prepare_correction_for_another_aim_is_a_mirror_image_and_goes_the_short_way():
    assert prepare.correction(88.0, -0.3, aim=350.0) == pytest.approx(98.0)
    assert prepare.correction(272.0, 0.3, aim=350.0) == pytest.approx(98.0)


def test_prepare_d_beta_and_d_s():
    theta = (0.02, 0.1, 0.004)
    assert prepare.d_beta(theta, "adjustment", 30, 40.0) == pytest.approx(0.02 * 30 + 0.1 * 40)
    assert prepare.d_beta(theta, "acceleration", 30, 40.0) == pytest.approx(40.0)
    assert prepare.d_s(theta, "adjustment") == pytest.approx(5e-3)
    assert prepare.d_s(theta, "acceleration") == pytest.approx(0.004)


def test_home_formulas():
    assert home.correction(300.0, 0.2) == pytest.approx(60.0)
    assert home.correction(50.0, -0.2) == pytest.approx(49.99)
    # (0.01 + 0.03 · 0.02) · 60 = 0.636
    assert home.d_beta(THETA_HIT, DT, 60.0) == pytest.approx(0.636)


@pytest.mark.parametrize(
    ("x", "y", "tolerance", "space"),
    [
        (-0.5, 0.0, 0.0, True),
        (-0.5, 0.39, 0.0, True),  # 0.519 − 0.39 = 0.129 > 0.12795
        (-0.5, 0.392, 0.0, False),
        (-0.5, -0.392, 0.0, False),
        (-0.845, 0.0, 0.0, True),  # 0.974 − 0.845 = 0.129
        (-0.847, 0.0, 0.0, False),
        (-0.5, 0.35, 0.05, False),
        (-0.8, 0.0, 0.05, False),
    ],
)
def test_enough_space(x, y, tolerance, space):
    assert enough_space(np.array([x, y]), tolerance) is space


BAND = (-0.7, -0.3)


def test_a_bank_shot_straight_at_the_side_rim_is_the_printed_aim():
    assert bank_aim(np.array([-0.5, -0.45]), BAND, 35.0, 0.05) == pytest.approx(90.0)
    assert bank_aim(np.array([-0.5, 0.45]), BAND, 35.0, 0.05) == pytest.approx(90.0)


def test_a_bank_shot_leads_into_the_band():
    # outside the band on the near side the push goes along +x, so it comes from an angle beyond 90°, and vice versa
    assert bank_aim(np.array([-0.76, -0.45]), BAND, 35.0, 0.05) > 95.0
    assert bank_aim(np.array([-0.22, -0.45]), BAND, 35.0, 0.05) < 85.0


def test_a_bank_shot_at_the_short_rim_comes_from_the_front_and_leaves_the_goal_alone():
    assert bank_aim(np.array([-0.9, -0.25]), BAND, 35.0, 0.05) == pytest.approx(0.0)
    assert 320.0 < bank_aim(np.array([-0.9, -0.40]), BAND, 35.0, 0.05) < 360.0
    assert bank_aim(np.array([-0.9, -0.1]), BAND, 35.0, 0.05) == pytest.approx(90.0)


def test_in_the_corner_the_mallet_stays_on_the_table():
    y = -0.485
    aim = np.radians(bank_aim(np.array([-0.9, y]), BAND, 35.0, 0.05))
    assert y + CONTACT * np.sin(aim) >= -(0.519 - MALLET.radius)
