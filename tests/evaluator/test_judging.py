import pytest
from hypothesis import given
from hypothesis import strategies as st

from airhockey.envs.editions import edition
from airhockey.evaluator.judging.tasks import judge, penalty, score, violated_episodes, wilson_interval, worst_class
from airhockey.evaluator.runs.records import EpisodeRecord, StepTime

RULES = edition("2023")


def record(violations: dict[str, int] | None = None, mean: float = 0.0, longest: float = 0.0) -> EpisodeRecord:
    time = StepTime(mean=mean, max=longest)
    return EpisodeRecord(env="7dof-hit", index=0, violations=violations or {}, computation_time=time)


@pytest.mark.parametrize(
    ("violations", "points"),
    [
        ({}, 0),
        ({"joint_pos_constr": 0, "ee_constr": 0}, 0),
        ({"joint_pos_constr": 1}, 2),
        ({"joint_vel_constr": 400}, 1),
        ({"ee_constr": 2}, 3),
        ({"link_constr": 2}, 3),
        ({"joint_pos_constr": 9, "joint_vel_constr": 9, "ee_constr": 9, "link_constr": 9}, 9),
    ],
)
def test_a_constraint_costs_its_points_once_per_episode(violations: dict[str, int], points: float) -> None:
    assert penalty(record(violations), RULES) == points


@pytest.mark.parametrize(
    ("mean", "longest", "points"),
    [
        (0.0, 0.02, 0),
        (0.0, 0.0201, 0.5),
        (0.0, 0.1, 0.5),
        (0.0, 0.11, 1),
        (0.0, 0.2, 1),
        (0.0, 0.21, 2),
        (0.02, 0.02, 0),
        (0.021, 0.03, 2),
    ],
)
def test_computation_time_costs_by_its_worst(mean: float, longest: float, points: float) -> None:
    assert penalty(record(mean=mean, longest=longest), RULES) == points


def test_violations_are_counted_in_episodes() -> None:
    records = [
        record({"ee_constr": 7, "joint_pos_constr": 0}),
        record({"ee_constr": 1, "joint_pos_constr": 0}),
        record(),
    ]
    assert violated_episodes(records) == {"ee_constr": 2, "joint_pos_constr": 0}


@pytest.mark.parametrize(
    ("points", "name"),
    [(0, "Deployable"), (500, "Deployable"), (500.5, "Improvable"), (1500, "Improvable"), (1500.5, "Non-deployable")],
)
def test_classes_at_their_limits(points: float, name: str) -> None:
    assert RULES.deployability.class_of(points) == name


def test_a_task_is_judged_as_it_is_and_at_the_rate_of_an_official_evaluation() -> None:
    """Two episodes, 3 and 2 points: 5 are deployable, 2500 in 1000 episodes are not."""
    verdict = judge([record({"ee_constr": 1, "unheard_of": 4}), record(mean=0.021, longest=0.03)], RULES)
    assert (verdict.episodes, verdict.penalty, verdict.late) == (2, 5.0, 1)
    assert (verdict.deployability, verdict.official_class) == ("Deployable", "Non-deployable")
    assert verdict.violations == {"ee_constr": 1, "unheard_of": 1}
    assert (verdict.success, verdict.failures) == (0.0, 0)


def test_the_worst_task_decides() -> None:
    assert worst_class(["Deployable", "Non-deployable", "Improvable"]) == "Non-deployable"
    assert worst_class(["Deployable", "Improvable"]) == "Improvable"


def test_phase_scores() -> None:
    phase, value = score({"7dof-hit": 0.5, "7dof-defend": 0.25, "7dof-prepare": 1.0}, RULES)
    assert phase == "phase-2"
    assert value == pytest.approx(0.4 * 0.5 + 0.4 * 0.25 + 0.2)
    phase, value = score({"3dof-defend": 0.5, "3dof-hit": 1.0}, RULES)
    assert phase == "phase-1"
    assert value == pytest.approx(0.75)
    assert score({"7dof-hit": 1.0, "7dof-defend": 1.0}, RULES) == (None, None)


@given(st.integers(1, 2000), st.data())
def test_wilson_interval_solves_its_definition(trials: int, data: st.DataObject) -> None:
    """Its ends are the shares p that lie z standard deviations sqrt(p (1 − p) / n) from the observed one."""
    successes = data.draw(st.integers(0, trials))
    observed, z = successes / trials, 1.959964
    low, high = wilson_interval(successes, trials)
    assert 0 <= low <= observed + 1e-12
    assert observed - 1e-12 <= high <= 1
    for end in (low, high):
        assert (observed - end) ** 2 == pytest.approx(z * z * end * (1 - end) / trials, abs=1e-9)
