"""`--set PART.NAME=VALUE`: what it changes, and what it refuses."""

import pytest

from airhockey import envs
from airhockey.agents.registry import AGENTS
from airhockey.agents.settings import asked_of, parsed, settings_in_use, with_settings
from airhockey.agents.thesis.parameters import thesis_parameters
from airhockey.errors import ConfigurationError


def test_values_are_read_as_yaml_and_by_part() -> None:
    with settings_in_use(["thesis.defend.predict=false", "thesis.hit.gap=1e-1", "control.solver=osqp"]):
        assert asked_of("thesis") == {"defend.predict": False, "hit.gap": 0.1}
        assert asked_of("control") == {"solver": "osqp"}
    assert asked_of("thesis") == {}


def test_nested_names_replace_what_they_name_and_nothing_else() -> None:
    before = {"a": {"b": 1, "c": 2}, "d": 3}
    assert with_settings(before, {"a.b": 5, "d": 4}) == {"a": {"b": 5, "c": 2}, "d": 4}
    assert before == {"a": {"b": 1, "c": 2}, "d": 3}


def test_the_rule_based_players_file_and_single_parameters_can_be_set() -> None:
    text, tuned = thesis_parameters("thesis"), thesis_parameters("tuned")
    with settings_in_use(
        ["thesis.parameters=thesis", "thesis.defend.predict=true", "thesis.hit.theta=[1.0, 2.0, 3.0, 4.0]"]
    ):
        found = thesis_parameters()
    assert found.defend.predict and not text.defend.predict
    assert found.hit.theta == (1.0, 2.0, 3.0, 4.0)
    assert found.prepare == text.prepare != tuned.prepare


@pytest.mark.parametrize(
    ("agent", "setting", "message"),
    [
        ("planner", "thesis.state_machine=false", "thesis"),
        ("thesis", "thesis.machine=false", "machine"),
        ("thesis", "thesis.hit.theta.0=1", "0"),
        ("thesis", "thesis.hit.gap", r"PART\.NAME=VALUE"),
        ("thesis", "gap=1", r"PART\.NAME=VALUE"),
        ("thesis", "thesis.hit.gap=wide", "finite number"),
        ("thesis", "thesis.parameters=best", "best"),
    ],
)
def test_what_cannot_be_set_is_refused(agent: str, setting: str, message: str) -> None:
    with pytest.raises(ConfigurationError, match=message):
        AGENTS[agent].build(envs.make("3dof-hit").env_info, settings=[setting])


def test_a_setting_is_split_at_its_first_equals_sign() -> None:
    assert parsed("thesis.parameters=/tmp/a=b.yaml") == ("thesis.parameters", "/tmp/a=b.yaml")
