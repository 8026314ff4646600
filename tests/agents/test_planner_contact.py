"""What the planners believe of a puck among mallet and rims, against the simulator."""

import numpy as np
import pytest

from airhockey import envs
from airhockey.agents.estimation.motion import advance, puck_motion
from airhockey.agents.planner.contacts.puck_physics import Mallet, clearance, put_on_table, step
from airhockey.agents.planner.contacts.redirection import RESTITUTION, redirecting, resting_place
from airhockey.agents.planner.pushes.push import coast
from airhockey.agents.table import CONTACT, HOME
from airhockey.envs.specs import IIWA, PUCK, TABLE

CONSTANTS = puck_motion().constants


def simulated(puck, steps):
    """The puck after control steps in which the arm stands still at home. Shape (5,)."""
    env = envs.make("7dof-defend")
    q = np.array(IIWA.start)
    env.reset(state=np.array([*puck[:2], 0.0, *puck[2:], *q, *np.zeros(7)]))
    for _ in range(steps):
        env.step(np.array([q, np.zeros(7)]))
    return env.base_observation[[0, 1, 3, 4, 5]]


@pytest.mark.parametrize(
    ("puck", "steps"),
    [
        ((-0.6, 0.0, -1.0, 0.0, 0.0), 25),  # straight at the mallet
        ((-0.6, 0.03, -1.0, 0.0, 0.0), 25),  # beside its centre: friction and spin
        ((-0.6, 0.02, -2.0, 0.0, 10.0), 15),
        ((-0.6, 0.3, -1.5, 1.0, 5.0), 10),  # at a side rim
        ((-0.6, 0.3, -1.5, 1.0, 5.0), 25),  # and then at the end
        ((-0.9, 0.3, -0.5, 0.5, 0.0), 25),
    ],
)
def test_contacts_are_those_of_the_simulator(puck, steps):
    state = np.array(puck)
    for _ in range(20 * steps):
        step(state, Mallet(*HOME, 0.0, 0.0), 1.0, 1.0)
    truth = simulated(puck, steps)
    np.testing.assert_allclose(state[:2], truth[:2], atol=0.012)
    np.testing.assert_allclose(state[2:4], truth[2:4], atol=0.03)


@pytest.mark.parametrize("speed", [0.5, 1.0, 2.0, 3.0])
def test_restitution_is_the_simulators(speed):
    distance = 0.1  # from the contact; damping takes half of that in [m]/[s]
    pucks = [simulated((HOME[0] + CONTACT + distance, 0.0, -speed, 0.0, 0.0), k) for k in range(30)]
    back = next(puck for puck in pucks if puck[2] > 0.0 and puck[0] > HOME[0] + CONTACT)
    before = speed - 0.5 * distance
    after = back[2] + 0.5 * (back[0] - HOME[0] - CONTACT)
    assert after / before == pytest.approx(RESTITUTION, abs=0.04)


@pytest.mark.parametrize("grip", [True, False])
def test_a_redirected_puck_leaves_as_wanted(grip):
    random = np.random.default_rng(4)
    for _ in range(40):
        state = np.array([-0.5, 0.0, random.uniform(-3, -1), random.uniform(-0.5, 0.5), random.uniform(-10, 10)])
        wanted = np.array([random.uniform(0.0, 0.5), random.uniform(-0.1, 0.1)])
        mallet, velocity = redirecting(state, wanted, grip)
        assert np.hypot(*(mallet - state[:2])) == pytest.approx(CONTACT)
        puck = state.copy()
        for _ in range(40):
            mallet = mallet + 0.001 * velocity
            step(puck, Mallet(*mallet, *velocity), 1.0 if grip else 0.0, 1.0)
        np.testing.assert_allclose(puck[2], wanted[0], atol=0.03)
        np.testing.assert_allclose(puck[3], wanted[1], atol=0.1 if grip else 0.03)  # its spin turns during the contact


def test_a_puck_rests_where_damping_leaves_it():
    state = np.array([-0.6, 0.1, 0.3, -0.2, 0.0])
    place = resting_place(state, 0.1, CONSTANTS)
    rolling = state.copy()
    while np.hypot(rolling[2], rolling[3]) > 0.1:
        rolling[:2] += 1e-4 * rolling[2:4]
        rolling[2:4] *= 1.0 - 1e-4 * PUCK.slide_damping / PUCK.mass
    np.testing.assert_allclose(place, rolling[:2], atol=1e-4)


def test_coasting_is_the_motion_in_small_steps():
    random = np.random.default_rng(0)
    compared = []
    for _ in range(100):
        start = np.array([random.uniform(-0.9, -0.3), random.uniform(0.2, 0.48), *random.uniform(-0.5, 0.5, 2), 1.0])
        ended, last = coast(start, CONSTANTS, 0.01, 2.0)
        state, time, expected = start.copy(), 0.0, 0
        while time < 2.0 - 1e-9 and expected == 0:
            advance(state, 0.001, CONSTANTS)
            time += 0.001
            off = state[0] > 0.0 or (state[0] < -CONSTANTS[0] and abs(state[1]) < TABLE.goal_width / 2)
            expected = 2 if off else int(abs(state[1]) < 0.01)
        assert ended == expected
        if ended != 2:
            compared.append(np.abs(last[:4] - state[:4]).max())
    assert len(compared) > 50
    assert np.quantile(compared, 0.95) < 2e-3  # in a corner the order of the bounces is a matter of the step


def test_the_gap_to_the_nearest_thing():
    side, end = TABLE.width / 2 - PUCK.radius, TABLE.length / 2 - PUCK.radius
    assert clearance(np.array([-0.5, side - 0.01, 0, 0, 0]), 0.0, 0.0) == pytest.approx(0.01)
    assert clearance(np.array([-end + 0.02, 0.2, 0, 0, 0]), 0.0, 0.0) == pytest.approx(0.02)
    assert clearance(np.array([-0.5, 0.0, 0, 0, 0]), -0.6, 0.0) == pytest.approx(0.1 - CONTACT)


def test_a_puck_believed_in_a_rim_is_put_beside_it():
    puck = np.array([-2.0, 1.0, 0.0, 0.0, 0.0])
    put_on_table(puck, 0.001)
    assert clearance(puck, 0.0, 0.0) == pytest.approx(0.001)
