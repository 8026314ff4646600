"""Contacts and hits, on collisions that were computed."""

import numpy as np
import pytest
from numpy.typing import NDArray

from airhockey.envs.specs import CONTROL_PERIOD, MALLET, PUCK
from airhockey.evaluator.analysis.contacts import contacts, hits

Array = NDArray[np.float64]
REACH = PUCK.radius + MALLET.radius


def collide(random: np.random.Generator, when: float, restitution: float = 0.8) -> tuple[Array, Array, Array, Array]:
    """A step in which a heavy, frictionless mallet meets the puck after a share `when` of it: rows for `contacts`."""
    angle = random.uniform(-np.pi, np.pi)
    normal = np.array([np.cos(angle), np.sin(angle)])  # from mallet to puck
    mallet_velocity = random.uniform(0.3, 1.5) * normal
    puck_velocity = random.uniform(-0.2, 0.2, 2)
    touch = random.uniform(-0.3, 0.3, 2)
    closing = (puck_velocity - mallet_velocity) @ normal
    after_velocity = puck_velocity - (1 + restitution) * closing * normal
    back, forth = when * CONTROL_PERIOD, (1 - when) * CONTROL_PERIOD
    mallet_touch = touch - REACH * normal
    before = np.r_[touch - back * puck_velocity, 0.0, puck_velocity, 0.0]
    after = np.r_[touch + forth * after_velocity, 0.0, after_velocity, 0.0]
    return before, after, mallet_touch - back * mallet_velocity, mallet_touch + forth * mallet_velocity


@pytest.mark.parametrize("when", [0.0, 0.1, 0.5, 0.9, 1.0])
def test_a_collision_at_any_moment_of_a_step_is_a_contact(when: float) -> None:
    random = np.random.default_rng(7)
    rows = [np.array(part) for part in zip(*(collide(random, when) for _ in range(200)), strict=True)]
    assert contacts(*rows).all()


def test_free_flight_friction_and_rims_are_no_contacts() -> None:
    still = np.array([[0.0, 0.0]])
    flying = np.array([[0.1, 0.0, 0.0, 2.0, 1.0, 0.0]])
    slower = flying.copy()
    slower[0, :2] += CONTROL_PERIOD * flying[0, 3:5]
    slower[0, 3:5] *= 0.99
    assert not contacts(flying, slower, still, still).any()
    bounced = slower.copy()
    bounced[0, 4] *= -1  # off the rim at the top, away from which no mallet is near
    aside = np.array([[0.0, 0.4, 0.0, 0.0, 0.0, 0.0]])
    assert not contacts(flying + aside, bounced + aside, still, still).any()
    towards = np.array([[0.09, 0.0, 0.0, 1.0, 0.0, 0.0]])
    back = towards * [[1, 1, 1, -1, 1, 1]]  # near the mallet, but turned towards it
    assert not contacts(towards, back, still, still).any()


def test_touches_within_three_steps_are_one_hit_unless_a_part_begins() -> None:
    touching = np.array([0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 1], dtype=bool)
    assert hits(touching, np.zeros(12, dtype=bool)).tolist() == [[1, 2], [5, 5], [9, 11]]
    begins = np.arange(12) == 11
    assert hits(touching, begins).tolist() == [[1, 2], [5, 5], [9, 10], [11, 11]]
    assert hits(np.array([1, 0, 1, 0], dtype=bool), np.zeros(4, dtype=bool)).tolist() == [[0, 2]]
    assert hits(np.zeros(4, dtype=bool), np.zeros(4, dtype=bool)).shape == (0, 2)
