"""The edition 2023 holds the challenge's numbers; section 4 and 5."""

import mujoco
import pytest

from airhockey import envs
from airhockey.envs.editions import available
from airhockey.errors import ConfigurationError


def test_points_and_limits():
    rules = envs.edition("2023")
    assert rules.penalty_points == {"joint_pos_constr": 2, "joint_vel_constr": 1, "ee_constr": 3, "link_constr": 3}
    assert rules.deployability_limits == (500, 1500)
    assert rules.score_weights["3dof"] == {"3dof-hit": 0.5, "3dof-defend": 0.5}
    assert rules.score_weights["7dof"] == {"7dof-hit": 0.4, "7dof-defend": 0.4, "7dof-prepare": 0.2}
    assert rules.game_penalty_per_episode == 1.5


@pytest.mark.parametrize(
    ("points", "expected"),
    [(0, "Deployable"), (500, "Deployable"), (500.5, "Improvable"), (1500, "Improvable"), (1501, "Non-deployable")],
)
def test_classes(points, expected):
    assert envs.edition("2023").deployability.class_of(points) == expected


@pytest.mark.parametrize(
    ("longest", "mean", "points"),
    [
        (0.02, 0.02, 0.0),
        (0.0201, 0.001, 0.5),
        (0.1, 0.001, 0.5),
        (0.1001, 0.001, 1.0),
        (0.2, 0.02, 1.0),
        (0.2001, 0.001, 2.0),
        (0.05, 0.0201, 2.0),
    ],
)
def test_points_for_computation_time(longest, mean, points):
    assert envs.edition("2023").time_penalty(longest, mean) == points


def test_an_edition_has_every_environment():
    assert available() == ("2023", "2025")
    assert set(envs.edition().environments) == set(envs.ENVIRONMENTS)
    assert list(envs.edition("2025").environments) == ["hit", "hit_single", "defend", "prepare", "tournament"]


@pytest.mark.parametrize(
    ("official", "ours"),
    [("hit", "7dof-hit"), ("hit_single", "7dof-hit_single"), ("defend", "7dof-defend"), ("prepare", "7dof-prepare")],
)
def test_the_names_of_2025_and_those_of_all_editions_are_the_same_environments(official, ours):
    env, same = envs.make(official, edition="2025"), envs.make(ours, edition="2025")
    assert env.name == same.name == official == env.env_info["env_name"]
    assert env.reset(seed=3).tobytes() == same.reset(seed=3).tobytes()
    with pytest.raises(ConfigurationError, match=f"environment of edition 2023 '{official}'"):
        envs.make(official)


def test_there_is_no_planar_arm_in_2025():
    with pytest.raises(
        ConfigurationError, match=r"edition 2025 '3dof-hit'; allowed: 7dof-defend, 7dof-hit, .*hit_single"
    ):
        envs.make("3dof-hit", edition="2025")


def test_the_rules_of_2025_are_those_of_2023_but_for_starts_names_and_scene():
    old, new = envs.edition("2023"), envs.edition("2025")
    differ = {field for field in new.__struct_fields__ if getattr(old, field) != getattr(new, field)}
    assert differ == {"edition", "starts", "environments", "scene", "score_weights", "phases"}
    assert new.score_weights == {"7dof": {"hit": 0.4, "defend": 0.4, "prepare": 0.2}}
    assert new.starts["serve"] == old.starts["serve"]


def contact_partners(env, gap=0.06):
    """The geoms that touch when both arms' mallets are put beside each other, 0.06 m apart."""
    model, data = env.simulation.model, env.simulation.data
    mallets = [model.geom(f"iiwa_{number}/ee") for number in (1, 2)]
    shift = data.geom_xpos[mallets[0].id] - data.geom_xpos[mallets[1].id] + [gap, 0.0, 0.0]
    model.body("iiwa_2/base").pos[:] += shift
    mujoco.mj_forward(model, data)
    return {frozenset(model.geom(g).name for g in contact.geom) for contact in data.contact}


def test_the_scene_of_2025():
    """Robot 1's mallet alone decides how it meets the puck; the arms pass through each other; the rim carries a mark."""
    for name in ("hit", "tournament"):
        model = envs.make(name, edition="2025").simulation.model
        first, second = model.geom("iiwa_1/ee"), model.geom("iiwa_2/ee")
        assert (first.priority[0], second.priority[0]) == (2, 0)
        assert (
            first.condim[0] == 4 and first.solref.tolist() == [0.02, 0.3] and first.friction.tolist() == [0.0, 0.0, 0.0]
        )
    mark, rim = model.geom("target"), model.body("rim")
    assert mark.bodyid[0] == rim.id and mark.id == rim.geomadr[0] + rim.geomnum[0] - 1
    assert mark.size[0] == 0.01 and mark.pos.tolist() == [0.0, 0.0, -0.05]
    assert mark.contype[0] == mark.conaffinity[0] == 0
    mallets = frozenset({"iiwa_1/ee", "iiwa_2/ee"})
    assert mallets in contact_partners(envs.make("tournament"))
    assert mallets not in contact_partners(envs.make("tournament", edition="2025"))


def test_the_scene_of_2023_has_nothing_of_it():
    for name in envs.ENVIRONMENTS[2:]:
        model = envs.make(name).simulation.model
        assert "target" not in {model.geom(k).name for k in range(model.ngeom)}
        assert model.geom("iiwa_1/ee").priority[0] == 0


def test_versions_name_what_results_depend_on():
    versions = envs.versions()
    assert set(versions) == {"airhockey", "mujoco", "numpy", "numba", "python"}
    assert versions["mujoco"].startswith("4.0.")
