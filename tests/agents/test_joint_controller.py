"""The joint controller keeps every limit whatever it is asked, reaches what can be reached, and brakes."""

from dataclasses import replace

import numpy as np
import pytest

from airhockey.agents.control.joint_controller import JointController
from airhockey.agents.control.kinematics import ArmKinematics
from airhockey.agents.control.parameters import control_parameters
from airhockey.agents.control.workspace import Workspace
from airhockey.envs.specs import IIWA, MALLET, PLANAR, TABLE

SPECS = pytest.mark.parametrize("spec", [IIWA, PLANAR], ids=["iiwa", "planar"])
DT = 0.02


def make(spec, **changes):
    workspace = Workspace.of({"robot": {"n_joints": spec.n_joints}})
    return JointController(ArmKinematics(spec), workspace, DT, replace(control_parameters(spec), **changes))


@SPECS
def test_positions_follow_velocities_by_equation_4_1(spec):
    control = make(spec)
    before = control.state
    for k in range(20):
        action = control.step(control.tip_position() + np.array([0.004, 0.001 * k]))
        expected = before.position + 0.5 * (before.velocity + action[1]) * DT
        np.testing.assert_allclose(action[0], expected, atol=1e-12)
        before = control.state


@SPECS
def test_no_target_however_wild_breaks_a_limit(spec):
    control = make(spec)
    rng = np.random.default_rng(10)
    edge = np.array([-spec.base_positions[0][0], 0.0]) - np.array([TABLE.length, TABLE.width]) / 2 + MALLET.radius
    velocity = control.state.velocity
    for k in range(400):
        if k % 8 == 0:
            target, speed = rng.uniform(-2.0, 4.0, 2), rng.uniform(-9.0, 9.0, 2)
        action = control.step(target, speed if k % 3 else None)
        assert np.all(np.abs(action[0]) <= 0.95 * spec.joint_position_limit[1])
        assert np.all(np.abs(action[1]) <= 0.95 * spec.joint_velocity_limit[1])
        assert np.all(np.abs(action[1] - velocity) <= DT * spec.joint_acceleration_limit[1] + 1e-9)
        velocity = action[1]
        tip = control.kinematics.position(action[0])
        assert abs(tip[2] - spec.desired_height) < 0.01
        assert tip[0] > edge[0] and abs(tip[1]) < -edge[1]
        assert np.all(control.kinematics.link_heights(action[0]) > 0.25)


@SPECS
def test_another_solver_gives_the_same_commands(spec):
    own, daqp = make(spec), make(spec, solver="daqp")
    rng = np.random.default_rng(11)
    exact = 0
    for k in range(600):
        if k % 6 == 0:
            target, speed = rng.uniform(0.4, 1.6, 2) - [0.0, 1.0], rng.uniform(-2.0, 2.0, 2)
        if k % 60 > 20:  # something that it can do
            target, speed = own.tip_position() + 0.02 * own.tip_velocity(), 0.9 * own.tip_velocity()
        daqp.state = own.state
        np.testing.assert_allclose(own.step(target, speed), daqp.step(target, speed), atol=1e-9)
        assert own.exact == daqp.exact
        exact += own.exact
    assert 50 < exact < 550


@SPECS
def test_a_reachable_target_is_reached_and_kept(spec):
    control = make(spec)
    target = np.array([0.9, 0.2])
    for _ in range(150):
        way = target - control.tip_position()
        control.step(control.tip_position() + 0.1 * way)
    np.testing.assert_allclose(control.tip_position(), target, atol=1e-3)
    np.testing.assert_allclose(control.state.velocity, 0.0, atol=0.02)


@SPECS
def test_a_moving_target_with_its_velocity_is_followed_exactly(spec):
    control = make(spec)
    centre, start = np.array([0.8, 0.0]), control.tip_position()
    blend = centre + np.array([0.1, 0.0]) - start
    for k in range(1, 200):
        t = k * DT
        share = min(1.0, t / 2.0)
        s, ds = share**2 * (3 - 2 * share), 6 * share * (1 - share) / 2.0
        circle = 0.1 * np.array([np.cos(t) - 1.0, np.sin(t)])
        rate = 0.1 * np.array([-np.sin(t), np.cos(t)])
        target, velocity = start + s * blend + s * circle, ds * (blend + circle) + s * rate
        control.step(target, velocity)
        assert control.exact
        if k > 5:
            np.testing.assert_allclose(control.tip_position(), target, atol=3e-4)


@SPECS
def test_braking_stops_the_arm(spec):
    control = make(spec)
    for _ in range(20):
        control.step(control.tip_position() + np.array([0.02, 0.01]))
    assert np.linalg.norm(control.tip_velocity()) > 0.3
    for _ in range(25):
        control.brake()
    assert np.linalg.norm(control.tip_velocity()) < 0.01
    stood = control.tip_position()
    np.testing.assert_allclose(control.hold()[1], 0.0)
    np.testing.assert_allclose(control.tip_position(), stood)
