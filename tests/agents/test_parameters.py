"""Parameter files: the package's own are complete, and a wrong one is refused in one clear line."""

import pathlib

import pytest
import yaml

from airhockey.agents.control.parameters import control_parameters
from airhockey.agents.thesis import parameters
from airhockey.agents.thesis.parameters import thesis_parameters
from airhockey.envs.specs import IIWA, PLANAR
from airhockey.errors import ConfigurationError

FOLDER = pathlib.Path(parameters.__file__).parent


def written(tmp_path, change):
    content = yaml.safe_load((FOLDER / "tuned.yaml").read_text(encoding="utf-8"))
    change(content)
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    return path


@pytest.mark.parametrize("name", ["tuned", "thesis", "tuned.yaml"])
def test_the_packages_own_files_are_valid(name):
    assert len(thesis_parameters(name).hit.theta) == 4


def test_the_published_theta_of_the_hit():
    assert thesis_parameters("thesis").hit.theta == (9.82381671e-3, 3.01454192e-2, 2.96120280e-4, 8.81876941e-5)


@pytest.mark.parametrize("spec", [IIWA, PLANAR])
def test_control_parameters_fit_their_robot(spec):
    p = control_parameters(spec)
    assert len(p.anchor) == len(p.anchor_weights) == spec.n_joints
    assert p.velocity_share < 0.95 and p.position_share < 0.95


def test_a_file_of_the_users_is_read(tmp_path):
    path = written(tmp_path, lambda c: c["defend"].update(cushion=0.2))
    assert thesis_parameters(path).defend.cushion == 0.2


def test_numbers_may_be_written_as_people_write_them(tmp_path):
    path = written(tmp_path, lambda c: c["defend"].update(cushion="2e-1"))
    assert thesis_parameters(path).defend.cushion == 0.2


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: c["hit"].update(theta=[1.0, 2.0, 3.0]), "theta: expected 4 values, not 3"),
        (lambda c: c["hit"].update(theta=0.1), "theta: expected a list"),
        (lambda c: c["hit"].update(theta=[1.0, 2.0, 3.0, "x"]), r"theta\[3\]: expected a finite number"),
        (lambda c: c["hit"].update(gap=float("nan")), "gap: expected a finite number"),
        (lambda c: c["hit"].update(gapp=0.1), "unknown parameter in .*hit 'gapp'.*mean 'gap'"),
        (lambda c: c["hit"].pop("gap"), "'gap' is missing"),
        (lambda c: c.update(attack={}), "unknown parameter in mine.yaml 'attack'"),
        (lambda c: c.update(hit=3), "hit: expected a mapping"),
        (lambda c: c["prepare"].update(bank_shot="yes"), "bank_shot: expected a value of type bool"),
    ],
)
def test_a_wrong_file_says_what_is_wrong(tmp_path, change, message):
    with pytest.raises(ConfigurationError, match=message) as caught:
        thesis_parameters(written(tmp_path, change))
    assert "\n" not in str(caught.value)


def test_an_unknown_file_lists_those_there_are():
    with pytest.raises(ConfigurationError, match=r"tunde.*thesis, tuned"):
        thesis_parameters("tunde")


def test_broken_yaml_is_one_line(tmp_path):
    path = tmp_path / "broken.yaml"
    path.write_text("hit: [1,\n  2", encoding="utf-8")
    with pytest.raises(ConfigurationError, match="is not valid YAML") as caught:
        thesis_parameters(path)
    assert "\n" not in str(caught.value)
