"""The disturbed plant: within the profile's ranges, drawn from the nominal values each time, unknown to the controller."""

import mujoco
import numpy as np
import pytest
from arms import ALL, standing

from airhockey import envs
from airhockey.envs.disturbances import Disturbances, Mismatch

HARSH = envs.load_disturbances("harsh").mismatch
FIELDS = ("body_mass", "body_inertia", "body_pos", "dof_damping", "dof_frictionloss", "geom_solref")


def fields(model):
    return {name: getattr(model, name).copy() for name in FIELDS}


def parts(env):
    """Bodies of links and of rods, degrees of freedom of joints, and geoms of rims in the scene."""
    model, robot = env.simulation.model, env.simulation.robot
    arms = [f"{robot.prefix}_{number}" for number in range(1, env.n_agents + 1)]
    links = [model.body(f"{arm}/{robot.link_prefix}_{k + 1}").id for arm in arms for k in range(robot.n_joints)]
    joints = [model.joint(f"{arm}/joint_{k + 1}").dofadr[0] for arm in arms for k in range(robot.n_joints)]
    rods = [model.body(f"{arm}/{'body_hand' if robot.n_joints == 3 else 'striker_joint_link'}").id for arm in arms]
    rims = [geom for geom in range(model.ngeom) if model.geom(geom).name.startswith("rim_")]
    return links, joints, rods, rims


@pytest.fixture(scope="module", params=["3dof-hit", "7dof-hit", "7dof-defend"])
def drawn(request):
    """An environment, its nominal fields, and its fields after each of many resets."""
    env = envs.make(request.param, disturbances=Disturbances("m", mismatch=HARSH))
    rows = []
    for seed in range(150):
        env.reset(seed=seed)
        rows.append(fields(env.simulation.model))
    return (
        env,
        fields(envs.make(request.param).simulation.model),
        {key: np.array([r[key] for r in rows]) for key in FIELDS},
    )


def test_factors_are_spread_over_their_ranges(drawn):
    env, nominal, now = drawn
    links, joints, _, rims = parts(env)
    mass = now["body_mass"][:, links] / nominal["body_mass"][links]
    uniform(mass, *HARSH.mass)
    np.testing.assert_allclose(now["body_inertia"][:, links], mass[..., None] * nominal["body_inertia"][links])
    if env.simulation.robot.n_joints == 7:  # the planar arm has no friction
        friction = now["dof_damping"][:, joints] / nominal["dof_damping"][joints]
        uniform(friction, *HARSH.joint_friction)
        np.testing.assert_allclose(now["dof_frictionloss"][:, joints], friction * nominal["dof_frictionloss"][joints])
    for field, part, bounds in (
        ("geom_solref", np.s_[rims, 1], HARSH.rim_damping),
        ("dof_damping", np.s_[-3:], HARSH.puck_damping),
    ):
        factors = np.array([row[part] / nominal[field][part] for row in now[field]])
        np.testing.assert_allclose(factors, factors[:, :1].repeat(factors.shape[1], axis=1))  # one for all of them
        uniform(factors[:, 0], *bounds)


def test_rods_are_longer_or_shorter_along_themselves(drawn):
    env, nominal, now = drawn
    rods = parts(env)[2]
    change = now["body_pos"][:, rods] - nominal["body_pos"][rods]
    along = nominal["body_pos"][rods] / np.linalg.norm(nominal["body_pos"][rods], axis=1)[:, None]
    length = (change * along).sum(axis=2)
    np.testing.assert_allclose(change, length[..., None] * along, atol=1e-12)
    assert length.std() == pytest.approx(HARSH.rod_length, rel=0.25)
    assert abs(length.mean()) < 5 * HARSH.rod_length / np.sqrt(length.size)


def test_nothing_else_changes(drawn):
    env, nominal, now = drawn
    links, joints, rods, rims = parts(env)
    touched = {
        "body_mass": np.s_[links],
        "body_inertia": np.s_[links],
        "body_pos": np.s_[rods],
        "dof_damping": np.s_[[*joints, -3, -2, -1]],
        "dof_frictionloss": np.s_[joints],
        "geom_solref": np.s_[rims, 1],
    }
    for field, part in touched.items():
        for row in now[field]:
            row[part] = nominal[field][part]
            np.testing.assert_array_equal(row, nominal[field])


def uniform(factors, low, high):
    """One factor per draw or joint, spread over the range and no further."""
    assert factors.min() >= low - 1e-9 and factors.max() <= high + 1e-9
    deviation = (high - low) / np.sqrt(12.0)
    assert abs(factors.mean() - (low + high) / 2) < 5.0 * deviation / np.sqrt(factors.size)
    assert factors.std() == pytest.approx(deviation, rel=0.2)


def test_a_seed_decides_the_plant_however_often_it_was_drawn_before():
    once, often = (envs.make("7dof-hit", disturbances="harsh") for _ in range(2))
    for seed in range(30):
        often.reset(seed=seed)
    for env in (once, often):
        env.reset(seed=99)
    for field in (*FIELDS, "body_subtreemass", "body_invweight0", "dof_invweight0", "dof_M0"):
        first, second = (getattr(env.simulation.model, field) for env in (once, often))
        np.testing.assert_array_equal(first, second)


def test_each_joint_link_and_robot_is_drawn_apart():
    env = envs.make("tournament", disturbances="harsh")
    env.reset(seed=0)
    nominal = envs.make("tournament").simulation.model
    links, _, rods, _ = parts(env)
    factors = env.simulation.model.body_mass[links] / nominal.body_mass[links]
    assert len(set(np.round(factors, 9))) == 14
    assert len({tuple(position) for position in env.simulation.model.body_pos[rods]}) == 2


def test_derived_constants_follow_the_masses():
    env = envs.make("7dof-prepare", disturbances=Disturbances("m", mismatch=Mismatch(mass=(0.5, 0.6))))
    env.reset(seed=0)
    model, nominal = env.simulation.model, envs.make("7dof-prepare").simulation.model
    assert model.body_subtreemass[0] == pytest.approx(model.body_mass.sum())
    assert np.all(model.dof_M0[:6] < nominal.dof_M0[:6])


@ALL
def test_controller_and_agents_know_only_the_nominal_arm(name):
    nominal, env = envs.make(name), envs.make(name, disturbances="harsh")
    env.reset(seed=3)
    models = [each.env_info["robot"]["robot_model"] for each in (env, nominal)]
    for field in (*FIELDS[:-1], "body_subtreemass", "dof_armature"):
        np.testing.assert_array_equal(*(getattr(model, field) for model in models))
    for ours, theirs in zip(env.simulation.arm, nominal.simulation.arm, strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_the_mismatch_is_felt():
    """A lighter arm under the nominal feed-forward sags upwards; a heavier one down."""
    height = {}
    for factor in (0.8, 1.0, 1.2):
        profile = Disturbances("m", mismatch=Mismatch(mass=(factor, factor)))
        env = envs.make("7dof-prepare", disturbances=profile)
        env.reset(seed=0)
        for _ in range(50):
            env.step(standing(env))
        height[factor] = env.simulation.data.body("iiwa_1/striker_joint_link").xpos[2]
    assert height[0.8] > height[1.0] > height[1.2]


@pytest.mark.parametrize("field", ["mass", "joint_friction", "rim_damping", "puck_damping"])
def test_a_range_of_one_value_is_that_value(field):
    env = envs.make("7dof-prepare", disturbances=Disturbances("m", mismatch=Mismatch(**{field: (1.25, 1.25)})))
    nominal = fields(envs.make("7dof-prepare").simulation.model)
    for seed in (0, 1):
        env.reset(seed=seed)
        now = fields(env.simulation.model)
        changed = {name for name in FIELDS if not np.allclose(now[name], nominal[name], rtol=1e-12, atol=0)}
        expected = {
            "mass": {"body_mass", "body_inertia"},
            "joint_friction": {"dof_damping", "dof_frictionloss"},
            "rim_damping": {"geom_solref"},
            "puck_damping": {"dof_damping"},
        }[field]
        assert changed == expected
        for name in expected:
            ratio = now[name] / np.where(nominal[name] == 0.0, 1.0, nominal[name])
            assert {1.25} <= set(np.round(ratio[nominal[name] != 0.0].ravel(), 9)) <= {1.0, 1.25}


def test_torque_noise_has_the_share_of_each_joints_limit(monkeypatch):
    env = envs.make("tournament", disturbances=Disturbances("t", torque=0.01))
    env.reset(seed=0)
    added = []
    step = env.simulation.step
    monkeypatch.setattr(
        env.simulation, "step", lambda action, noise, k: (added.append(noise), step(action, noise, k))[1]
    )
    for _ in range(60):
        env.step(standing(env))
    noise = np.array(added)
    assert noise.shape == (60, 20, 2, 7)
    limit = np.array([320, 320, 176, 176, 110, 40, 40])
    np.testing.assert_allclose(noise.std(axis=(0, 1, 2)), 0.01 * limit, rtol=5.0 / np.sqrt(2 * 2400))
    assert np.abs(noise.mean(axis=(0, 1, 2)) / limit).max() < 0.01 * 5.0 / np.sqrt(2400)
    rows = noise.reshape(1200, 14)
    assert abs(np.corrcoef(rows.T) - np.eye(14)).max() < 5.0 / np.sqrt(1200)


def test_the_compiled_scene_is_nominal_to_the_bit_without_a_mismatch():
    env = envs.make("7dof-hit", disturbances=Disturbances("t", torque=0.01, delay=1))
    env.reset(seed=0)
    sizes = []
    for model in (env.simulation.model, envs.make("7dof-hit").simulation.model):
        buffer = np.zeros(mujoco.mj_sizeModel(model), dtype=np.uint8)
        mujoco.mj_saveModel(model, None, buffer)
        sizes.append(buffer.tobytes())
    assert sizes[0] == sizes[1]
