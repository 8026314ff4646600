"""The compiled scenes against the challenge's tables (section 1)."""

import mujoco
import numpy as np
import pytest
from arms import episode_bits

from airhockey import envs
from airhockey.envs import scene
from airhockey.envs.specs import IIWA, PLANAR

SCENES = {"planar": (PLANAR, 1), "iiwa": (IIWA, 1), "two": (IIWA, 2)}
PLANAR_BODIES = ("base", "body_1", "body_2", "body_3", "body_hand", "body_ee")
IIWA_BODIES = ("base", *(f"link_{k}" for k in range(1, 8)), "striker_joint_link", "striker_mallet")
MASSES = {  # without the base, which is welded to the world
    "planar_robot": (3, 2, 2, 0.1, 0.1),
    "iiwa": (8.240527, 6.357896, 4.042756, 3.642249, 2.580896, 2.760564, 1.285417, 0.1, 0.283),
}
RANGES = {
    "planar_robot": (2.9670597283903604, 1.8, 2.0943951023931953),
    "iiwa": (2.96706, 2.0944, 2.96706, 2.0944, 2.96706, 2.0944, 3.05433),
}
TORQUES = {"planar_robot": (100, 50, 30), "iiwa": (320, 320, 176, 176, 110, 40, 40, 10, 10)}


@pytest.fixture(scope="module", params=SCENES)
def model(request):
    return scene.game_model(*SCENES[request.param], visual=False)


def names(model, kind, count):
    return [mujoco.mj_id2name(model, kind, index) for index in range(count)]


def robots(model):
    """(prefix, number) of each robot in the scene."""
    bodies = names(model, mujoco.mjtObj.mjOBJ_BODY, model.nbody)
    return [(p, n) for p in ("planar_robot", "iiwa") for n in (1, 2) if f"{p}_{n}/base" in bodies]


def bodies_of(prefix):
    return PLANAR_BODIES if prefix == "planar_robot" else IIWA_BODIES


def test_options(model):
    option = model.opt
    assert (option.timestep, option.impratio, option.iterations, option.tolerance) == (0.001, 1.0, 100, 1e-8)
    assert option.integrator == mujoco.mjtIntegrator.mjINT_EULER
    assert option.solver == mujoco.mjtSolver.mjSOL_NEWTON
    assert option.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
    assert option.gravity.tolist() == [0.0, 0.0, -9.81]


def test_bodies_come_in_the_order_that_decides_contacts(model):
    bodies = names(model, mujoco.mjtObj.mjOBJ_BODY, model.nbody)
    expected = [f"{prefix}_{number}/{body}" for prefix, number in robots(model) for body in bodies_of(prefix)]
    assert bodies == ["world", *expected, "table_surface", "rim", "puck_base", "puck"]
    assert np.all(np.diff(model.geom_bodyid) >= 0)
    joints = names(model, mujoco.mjtObj.mjOBJ_JOINT, model.njnt)
    of_robots = []
    for prefix, number in robots(model):
        of_robots += [f"{prefix}_{number}/joint_{k + 1}" for k in range(len(RANGES[prefix]))]
        if prefix == "iiwa":
            of_robots += [f"iiwa_{number}/striker_joint_1", f"iiwa_{number}/striker_joint_2"]
    assert joints == [*of_robots, "puck_x", "puck_y", "puck_yaw"]
    assert names(model, mujoco.mjtObj.mjOBJ_ACTUATOR, model.nu) == of_robots


def test_masses_ranges_and_torques(model):
    for prefix, number in robots(model):
        name = f"{prefix}_{number}"
        masses = [model.body(f"{name}/{body}").mass[0] for body in bodies_of(prefix)[1:]]
        np.testing.assert_allclose(masses, MASSES[prefix], rtol=1e-12)
        for k, limit in enumerate(RANGES[prefix]):
            np.testing.assert_allclose(model.joint(f"{name}/joint_{k + 1}").range, [-limit, limit], rtol=1e-12)
        if prefix == "iiwa":
            for k in (1, 2):
                np.testing.assert_array_equal(model.joint(f"{name}/striker_joint_{k}").range, [-1.5708, 1.5708])
            mallet = model.body(f"{name}/striker_mallet")
            np.testing.assert_allclose(mallet.ipos, [0, 0, 0.0682827])
            np.testing.assert_allclose(mallet.inertia, [0.005] * 3)
    assert np.array_equal(model.jnt_limited, [1] * (model.njnt - 3) + [0] * 3)
    torques = [torque for prefix, _ in robots(model) for torque in TORQUES[prefix]]
    np.testing.assert_array_equal(model.actuator_ctrlrange, np.outer(torques, [-1.0, 1.0]))
    assert np.all(model.actuator_ctrllimited)
    assert model.body("puck").mass[0] == 0.01
    np.testing.assert_allclose(model.body("puck").inertia, [2.5e-6, 2.5e-6, 5e-6])


def test_friction_and_armature_are_where_the_table_has_them(model):
    damping = {"planar_robot": [0.0] * 3}
    damping["iiwa"] = [0.33032, 0.21216, 0.1, 0.219041, 0.185923, 0.1, 0.1, 0.0, 0.0]
    loss = {"planar_robot": [0.0] * 3}
    loss["iiwa"] = [0.384477, 0.496333, 0.173951, 0.3751, 0.481099, 0.196149, 0.299238, 0.0, 0.0]
    expected = [value for prefix, _ in robots(model) for value in damping[prefix]]
    np.testing.assert_allclose(model.dof_damping, [*expected, 0.005, 0.005, 2e-6])
    expected = [value for prefix, _ in robots(model) for value in loss[prefix]]
    np.testing.assert_allclose(model.dof_frictionloss, [*expected, 0.0, 0.0, 0.0])
    armature = [0.01 * (k == 6) for prefix, _ in robots(model) for k in range(len(damping[prefix]))]
    np.testing.assert_allclose(model.dof_armature, [*armature, 0.0, 0.0, 0.0])


def test_bases_stand_at_the_table_ends(model):
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for prefix, number in robots(model):
        base = data.body(f"{prefix}_{number}/base")
        side = 1.0 if number == 1 else -1.0
        np.testing.assert_allclose(base.xpos, [-1.51 * side, 0.0, -0.1])
        np.testing.assert_allclose(base.xmat.reshape(3, 3), np.diag([side, side, 1.0]), atol=1e-12)


def test_what_may_not_touch(model):
    signatures = {(int(pair) >> 16, int(pair) & 0xFFFF) for pair in model.exclude_signature}
    excluded = {frozenset(model.body(body).name for body in pair) for pair in signatures}
    expected = {frozenset({"puck", "table_surface"})}
    for prefix, number in robots(model):
        for body in bodies_of(prefix):
            expected |= {frozenset({f"{prefix}_{number}/{body}", part}) for part in ("table_surface", "rim")}
        if prefix == "iiwa":
            expected.add(frozenset({f"iiwa_{number}/striker_mallet", "world"}))
    assert excluded == expected


def test_what_can_touch_has_the_contact_parameters_of_the_table(model):
    rim = (6, 1, [10000.0, 0.0, 0.0], [0.0075, 0.1], [0.99, 0.999, 0.001, 0.5, 2.0])
    for name in ("rim_left", "rim_right", "rim_home_l", "rim_home_r", "rim_away_l", "rim_away_r"):
        assert contact(model, name) == rim
    surface = (4, 1, [0.08, 0.08, 0.0], [0.0125, 0.5], [0.9, 0.999, 0.001, 0.5, 2.0])
    assert contact(model, "surface") == surface
    assert contact(model, "puck")[:4] == (4, 0, [1.0, 0.005, 0.0001], [0.02, 0.3])
    for prefix, number in robots(model):
        priority = 2 if prefix == "planar_robot" else 0
        assert contact(model, f"{prefix}_{number}/ee")[:4] == (4, priority, [0.0, 0.0, 0.0], [0.02, 0.3])
    for name in ("rim_home_top", "rim_away_top"):
        assert model.geom(name).contype[0] == model.geom(name).conaffinity[0] == 0


def contact(model, name):
    geom = model.geom(name)
    numbers = [list(np.round(field, 12)) for field in (geom.friction, geom.solref, geom.solimp)]
    return (int(geom.condim[0]), int(geom.priority[0]), *numbers)


def test_sizes_and_places_of_the_table_and_the_discs(model):
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for name, size, position in (
        ("surface", (1.064, 0.609, 0.0505), (0, 0, -0.0505)),
        ("rim_left", (1.064, 0.045, 0.015), (0, 0.564, 0.015)),
        ("rim_right", (1.064, 0.045, 0.015), (0, -0.564, 0.015)),
        ("rim_home_top", (0.045, 0.519, 0.01), (-1.019, 0, 0.02)),
        ("rim_away_top", (0.045, 0.519, 0.01), (1.019, 0, 0.02)),
    ):
        np.testing.assert_allclose(model.geom(name).size, size, atol=1e-12)
        np.testing.assert_allclose(data.geom(name).xpos, position, atol=1e-12)
    np.testing.assert_allclose(model.geom("puck").size[:2], [0.03165, 0.01])
    for prefix, number in robots(model):
        half_height = 0.01 if prefix == "planar_robot" else 0.03
        np.testing.assert_allclose(model.geom(f"{prefix}_{number}/ee").size[:2], [0.04815, half_height])


def test_the_rim_blocks_leave_the_goals_open_with_rounded_corners(model):
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mesh = model.mesh("rim_block")
    first = mesh.vertadr[0]
    vertices = model.mesh_vert[first : first + mesh.vertnum[0]]
    assert mesh.vertnum[0] == 36 and mesh.facenum[0] == 68
    for name, x, y in (("home_l", 1, 1), ("home_r", 1, -1), ("away_l", -1, 1), ("away_r", -1, -1)):
        geom = data.geom(f"rim_{name}")
        world = vertices @ geom.xmat.reshape(3, 3).T + geom.xpos
        outline = 1000.0 * np.abs(world - [1.019 * x, 0.322 * y, 0.0])  # from the block's middle, in [mm]
        toward_goal = (world[:, 1] - 0.322 * y) * y < 0
        assert np.all((np.abs(world[:, 2]) < 1e-7) | (np.abs(world[:, 2] - 0.02) < 1e-7))
        centres = np.array([45.0 - 5.0, 197.0 - 5.0])
        rounded = np.linalg.norm(outline[toward_goal, :2] - centres, axis=1)
        np.testing.assert_allclose(rounded, 5.0, atol=1e-3)
        np.testing.assert_allclose(outline[~toward_goal, :2], np.tile([45.0, 197.0], (4, 1)), atol=1e-3)
        assert toward_goal.sum() == 2 * 2 * 8
        assert np.abs(world[:, 1]).min() == pytest.approx(0.125, abs=1e-6)
        assert np.abs(world[:, 0]).min() == pytest.approx(0.974, abs=1e-6)


@pytest.mark.parametrize("robot", [PLANAR, IIWA], ids=["planar", "iiwa"])
def test_the_arm_alone_stands_at_the_origin_without_the_mallet(robot):
    model = scene.robot_model(robot)
    bodies = names(model, mujoco.mjtObj.mjOBJ_BODY, model.nbody)
    expected = [f"{robot.prefix}_1/{body}" for body in bodies_of(robot.prefix) if body != "striker_mallet"]
    assert bodies == ["world", *expected]
    assert model.nq == robot.n_joints
    masses = MASSES[robot.prefix][: -1 if robot is IIWA else None]
    assert model.body_mass[2:].sum() == pytest.approx(sum(masses))
    assert not np.any(model.body(f"{robot.prefix}_1/base").pos)


@pytest.mark.parametrize("name", ["3dof-defend", "7dof-defend", "tournament"])
def test_a_drawn_arm_moves_bit_for_bit_like_a_bare_one(name):
    told = []
    for visual in (False, True):
        env = envs.make(name, visual=visual)
        env.reset(seed=1)
        told.append(episode_bits(env, 40))
    assert told[0] == told[1]


def test_what_is_only_drawn_has_no_mass_and_touches_nothing():
    for robot, count in SCENES.values():
        bare, drawn = (scene.game_model(robot, count, visual) for visual in (False, True))
        assert drawn.ngeom > bare.ngeom
        solid = (drawn.geom_contype != 0) | (drawn.geom_conaffinity != 0)
        of_bare = (bare.geom_contype != 0) | (bare.geom_conaffinity != 0)
        np.testing.assert_array_equal(drawn.geom_bodyid[solid], bare.geom_bodyid[of_bare])
        for field in ("body_mass", "body_inertia", "body_ipos", "dof_damping", "body_invweight0", "dof_invweight0"):
            np.testing.assert_array_equal(getattr(drawn, field), getattr(bare, field))
