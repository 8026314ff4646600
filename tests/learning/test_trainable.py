"""θ by name: what is trained, where it is in a parameter file, and what is said about names that there are not."""

import numpy as np
import pytest

from airhockey.agents.thesis.parameters import thesis_parameters
from airhockey.errors import ConfigurationError
from airhockey.learning.pgpe import trainable

TUNED = thesis_parameters("tuned")


def test_a_task_trains_the_thesiss_theta():
    assert trainable.names_of("hit") == [f"hit.theta.{k}" for k in range(4)]
    assert len(trainable.names_of("defend")) == 5
    assert len(trainable.names_of("prepare")) == 3
    assert "hit.theta.0" in trainable.names_of("home")
    assert trainable.names_of("switcher")[0] == "switcher.defend_speed"


def test_some_can_be_fixed_and_all_but_one():
    assert trainable.names_of("hit", fixed=["0", "hit.theta.3"]) == ["hit.theta.1", "hit.theta.2"]
    assert trainable.names_of("hit", only="2") == ["hit.theta.2"]
    assert trainable.names_of("hit", asked=["hit.theta.", "margins.velocity"])[-1] == "margins.velocity_share"


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"fixed": ["7"]}, "indices 0 to 3"),
        ({"fixed": ["hit.thera.0"]}, "Did you mean 'hit.theta.0'"),
        ({"only": "-1"}, "'-1'"),
        ({"asked": ["jump."]}, "'jump.'"),
        ({"fixed": ["0", "1", "2", "3"]}, "nothing is left"),
    ],
)
def test_bad_names_are_answered_with_good_ones(given, message):
    with pytest.raises(ConfigurationError, match=message):
        trainable.names_of("hit", **given)


def test_every_value_goes_in_and_comes_out_again():
    names = list(trainable.ranges())
    lower, upper = trainable.bounds(names)
    middle = 0.5 * (lower + upper)
    changed = trainable.replaced(TUNED, dict(zip(names, middle, strict=True)))
    np.testing.assert_array_equal(trainable.read(changed, names), middle)
    assert changed.hit.theta[2] == 0.015 and changed.margins.velocity_share == 0.75


@pytest.mark.parametrize("source", ["tuned", "thesis"])
def test_what_we_ship_is_within_the_bounds(source):
    names = [name for name in trainable.ranges() if not name.startswith("margins")]
    lower, upper = trainable.bounds(names)
    values = trainable.read(thesis_parameters(source), names)
    assert ((lower <= values) & (values <= upper)).all()
    assert all(one.lower < one.upper and 0.0 < one.sigma < one.upper - one.lower for one in trainable.ranges().values())


def test_a_written_file_is_read_as_it_was(tmp_path):
    changed = trainable.replaced(TUNED, {"hit.theta.0": 0.123456789, "margins.velocity_share": 0.7})
    path = tmp_path / "mine.yaml"
    path.write_text(trainable.as_yaml(changed, ["where it comes from"]))
    assert thesis_parameters(path) == changed
    assert path.read_text().startswith("# where it comes from\n")


def test_a_parameter_without_a_value_has_no_start():
    with pytest.raises(ConfigurationError, match=r"--set margins\.velocity_share"):
        trainable.read(TUNED, ["margins.velocity_share"])


def test_an_unknown_parameter_is_not_set():
    with pytest.raises(ConfigurationError, match=r"'hit\.speed'"):
        trainable.replaced(TUNED, {"hit.speed": 1.0})


def test_a_mean_on_its_bound_is_named():
    names = trainable.names_of("hit")[:3]
    lower, upper = trainable.bounds(names)
    middle = 0.5 * (lower + upper)
    assert trainable.on_bounds(names, middle) == []
    assert trainable.on_bounds(names, np.array([lower[0], middle[1], upper[2]])) == [names[0], names[2]]
