"""Kinematics against finite differences and MuJoCo's robot-only model."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from airhockey import envs
from airhockey.agents.control.hitting_posture import hitting_posture
from airhockey.agents.control.inverse_kinematics import inverse_kinematics
from airhockey.agents.control.kinematics import ArmKinematics
from airhockey.agents.control.pinocchio_model import pinocchio_model
from airhockey.envs.specs import IIWA, PLANAR

ROBOTS = [("7dof-prepare", IIWA, "iiwa_1/striker_joint_link"), ("3dof-hit", PLANAR, "planar_robot_1/body_ee")]
SPECS = pytest.mark.parametrize("spec", [IIWA, PLANAR], ids=["iiwa", "planar"])


def random_joints(spec, seed, count=20):
    rng = np.random.default_rng(seed)
    return rng.uniform(*(0.9 * spec.joint_position_limit), size=(count, spec.n_joints))


def differences(function, q, h=1e-6):
    columns = [(function(q + h * e) - function(q - h * e)) / (2 * h) for e in np.eye(len(q))]
    return np.array(columns).T


@pytest.mark.parametrize(("name", "spec", "tip"), ROBOTS)
def test_positions_are_mujocos(name, spec, tip):
    kinematics, model = ArmKinematics(spec), envs.make(name).env_info["robot"]["robot_model"]
    data = mujoco.MjData(model)
    for q in random_joints(spec, 0):
        data.qpos[:] = q
        mujoco.mj_fwdPosition(model, data)
        np.testing.assert_allclose(kinematics.position(q), data.body(tip).xpos, atol=1e-9)
        np.testing.assert_allclose(kinematics.rotation(q), data.body(tip).xmat.reshape(3, 3), atol=1e-9)
        if kinematics.has_link_heights:
            heights = [data.body(f"iiwa_1/link_{k}").xpos[2] for k in (4, 7)]
            np.testing.assert_allclose(kinematics.link_heights(q), heights, atol=1e-9)


@SPECS
def test_pinocchios_model_is_the_same_arm(spec):
    kinematics, (model, tip) = ArmKinematics(spec), pinocchio_model(spec)
    data = model.createData()
    for q in random_joints(spec, 4):
        jacobian = pin.computeFrameJacobian(model, data, q, tip, pin.LOCAL_WORLD_ALIGNED)[:3]
        placement = pin.updateFramePlacement(model, data, tip)
        np.testing.assert_allclose(kinematics.position(q), placement.translation, atol=1e-12)
        np.testing.assert_allclose(kinematics.rotation(q), placement.rotation, atol=1e-12)
        np.testing.assert_allclose(kinematics.jacobian(q), jacobian, atol=1e-12)


@SPECS
def test_jacobian_is_the_derivative_of_the_position(spec):
    kinematics = ArmKinematics(spec)
    for q in random_joints(spec, 1):
        np.testing.assert_allclose(kinematics.jacobian(q), differences(kinematics.position, q), atol=1e-8)


def test_height_rows_are_the_derivatives_of_the_heights():
    kinematics = ArmKinematics(IIWA)
    for q in random_joints(IIWA, 2):
        heights, rows = kinematics.link_heights_and_jacobian(q)
        np.testing.assert_allclose(heights, kinematics.link_heights(q))
        np.testing.assert_allclose(rows, differences(kinematics.link_heights, q), atol=1e-8)


def test_the_planar_robot_has_no_link_heights_and_a_fixed_height():
    kinematics = ArmKinematics(PLANAR)
    q = np.array(PLANAR.start)
    heights, rows = kinematics.link_heights_and_jacobian(q)
    assert heights.shape == (0,) and rows.shape == (0, 3)
    assert kinematics.position(q)[2] == pytest.approx(PLANAR.desired_height)
    assert np.all(kinematics.jacobian(q)[2] == 0)


@SPECS
def test_the_start_is_at_the_home_position(spec):
    position = ArmKinematics(spec).position(np.array(spec.start))
    np.testing.assert_allclose(position, [0.65, 0.0, spec.desired_height], atol=1e-4)


@SPECS
def test_inverse_kinematics_brings_the_tip_to_the_target(spec):
    kinematics = ArmKinematics(spec)
    rng = np.random.default_rng(3)
    for _ in range(20):
        target = np.array([rng.uniform(0.65, 1.25), rng.uniform(-0.4, 0.4), spec.desired_height])
        q = inverse_kinematics(kinematics, target, np.array(spec.start))
        assert q is not None
        np.testing.assert_allclose(kinematics.position(q), target, atol=2e-5)
        assert np.all(np.abs(q) <= 0.92 * spec.joint_position_limit[1] + 1e-12)


@SPECS
def test_inverse_kinematics_says_when_a_point_is_out_of_reach(spec):
    assert inverse_kinematics(ArmKinematics(spec), np.array([2.5, 0.0, 0.1]), np.array(spec.start)) is None


def test_the_hitting_posture_stays_on_the_point_and_is_faster_than_where_it_started():
    kinematics = ArmKinematics(IIWA)
    point, direction = np.array([1.0, 0.2, IIWA.desired_height]), np.array([1.0, 0.0])
    limit = 0.9 * IIWA.joint_velocity_limit
    plain = hitting_posture(kinematics, point, direction, np.array(IIWA.start), limit, iterations=0)
    best = hitting_posture(kinematics, point, direction, np.array(IIWA.start), limit)
    np.testing.assert_allclose(kinematics.position(best.q), point, atol=2e-5)
    assert best.speed > plain.speed
    assert hitting_posture(kinematics, np.array([2.5, 0.0, 0.1]), direction, np.array(IIWA.start), limit) is None
