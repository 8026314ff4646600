"""The edition 2023 holds the challenge's numbers; section 4 and 5."""

import pytest

from airhockey import envs
from airhockey.envs.editions import available


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
    assert available() == ("2023",)
    assert set(envs.edition().environments) == set(envs.ENVIRONMENTS)


def test_versions_name_what_results_depend_on():
    versions = envs.versions()
    assert set(versions) == {"airhockey", "mujoco", "numpy", "numba", "python"}
    assert versions["mujoco"].startswith("4.0.")
