"""Joint trajectories for an arm, and the check of its limits."""

import json
from pathlib import Path

import numpy as np
import pytest
from command_line import Hockey

from airhockey.envs.specs import IIWA, SOFT_LIMIT
from airhockey.evaluator.runs.reader import Run, open_source
from airhockey.evaluator.runs.trajectories import read_episode
from airhockey.exporting.demonstrations import Demonstration, Demonstrations, of_run
from airhockey.exporting.joint_trajectory import (
    JointTrajectory,
    as_csv,
    as_ros2,
    joint_names,
    read_trajectory,
    trajectory_of,
)
from airhockey.exporting.limit_checks import check

ENV = "7dof-hit"
FIELDS = ("time", "position", "velocity", "acceleration")


def resting(points: int = 4) -> JointTrajectory:
    """The arm stays where episodes begin."""
    names = tuple(f"joint_{k}" for k in range(1, 8))
    nothing = np.zeros((points, 7))
    return JointTrajectory(names, 0.02 * np.arange(points), np.tile(IIWA.start, (points, 1)), nothing, nothing.copy())


@pytest.mark.parametrize("form", [as_csv, as_ros2])
def test_a_trajectory_reads_back_as_it_was(form, run: Path, tmp_path: Path) -> None:
    source = open_source(run)
    assert isinstance(source, Run)
    demonstrations = of_run(source, ENV)
    trajectory = trajectory_of(demonstrations, demonstrations.read("1"))
    arrays = read_episode(run / "trajectories.h5", ENV, 1)
    assert np.array_equal(trajectory.position[1:], arrays["actions"][:, 0])
    assert np.array_equal(trajectory.velocity[1:], arrays["actions"][:, 1])
    assert np.array_equal(trajectory.position[0], arrays["observations"][0, 6:13])
    path = tmp_path / "trajectory"
    path.write_text(form(trajectory))
    again = read_trajectory(path)
    assert again.names == joint_names(demonstrations)
    for field in FIELDS:
        assert np.allclose(getattr(again, field), getattr(trajectory, field), rtol=0.0, atol=1e-12)
    if form is as_ros2:
        message = json.loads(path.read_text())
        assert message["points"][55]["time_from_start"] == {"sec": 1, "nanosec": 100_000_000}


@pytest.mark.parametrize(("order", "shape"), [(1, (5, 7)), (3, (5, 2, 7)), (5, (5, 3, 7)), (None, (5, 20, 3, 7))])
def test_every_order_of_actions_is_a_trajectory(order: int | None, shape: tuple[int, ...]) -> None:
    time = 0.02 * np.arange(1, 6)
    actions = np.zeros(shape)
    if order == 1:
        actions[:] = time[:, None] ** 2
    else:
        rows = actions[:, -1] if order is None else actions
        for k, value in zip(range(rows.shape[1]), (time**2, 2.0 * time, 2.0 + 0.0 * time), strict=False):
            rows[:, k] = value[:, None]
    demonstrations = Demonstrations(ENV, "2023", "a", order, "commands", "ideal", [], lambda name: demonstration)
    demonstration = Demonstration("0", np.zeros((6, 20)), actions, np.zeros(5), True, True)
    trajectory = trajectory_of(demonstrations, demonstration)
    whole = np.concatenate([[0.0], time])
    assert np.allclose(trajectory.position, (whole**2)[:, None])
    assert np.allclose(trajectory.velocity[1:-1], 2.0 * whole[1:-1, None])
    assert np.allclose(trajectory.acceleration[2:-2], 2.0)


def test_an_arm_at_rest_is_within_every_limit() -> None:
    verdict = check(resting())
    assert (verdict.robot, verdict.points, verdict.violations) == ("iiwa", 4, ())


def test_a_limit_is_violated_from_where_it_is_crossed() -> None:
    soft = SOFT_LIMIT * IIWA.joint_velocity_limit[1]
    trajectory = resting()
    trajectory.velocity[2, 6] = soft[6]
    assert check(trajectory).violations == ()
    trajectory.velocity[2, 6] *= 1.001
    (violation,) = check(trajectory).violations
    assert (violation.what, violation.point, violation.time) == ("velocity of joint_7", 2, 0.04)
    assert violation.allowed == pytest.approx(soft[6])


def test_a_jump_between_slow_points_is_found_between_them() -> None:
    trajectory = resting()
    trajectory.position[2:, 6] += 0.2  # [rad] in 0.02 s, and every point says that it stands still
    (violation,) = check(trajectory).violations
    assert (violation.what, violation.point) == ("velocity of joint_7", 1)
    assert violation.value > 10.0


def test_the_mallet_has_to_stay_on_the_table() -> None:
    trajectory = resting(60)
    trajectory.position[:, 1] += np.linspace(0.0, 0.1, 60)
    trajectory.velocity[:, 1] = 0.1 / (59 * 0.02)
    (violation,) = check(trajectory).violations
    assert violation.what == "mallet below the table's height"
    assert 0.0 < violation.value < 0.001  # [m]


def test_commands_of_a_run_are_written_and_checked(hockey: Hockey, run: Path) -> None:
    status, out, _ = hockey(f"export {run} --env {ENV} --format csv-joints --episodes 0,2 -o arm")
    assert status == 0 and "hockey check-trajectory arm/0.csv" in out
    assert hockey("check-trajectory arm/0.csv arm/2.csv") == (
        0,
        "".join(f"arm/{k}.csv: 501 points, 10.00 s, iiwa: within every limit\n" for k in (0, 2)),
        "",
    )


def test_a_violation_is_named_and_status_3(hockey: Hockey) -> None:
    trajectory = resting()
    trajectory.acceleration[3, 0] = 1e3
    Path("fast.json").write_text(as_ros2(trajectory))
    status, out, err = hockey("check-trajectory fast.json")
    assert (status, err) == (3, "")
    assert "acceleration of joint_1: +1000 rad/s²" in out and "at 0.060 s (from point 3)" in out
    status, out, _ = hockey("check-trajectory fast.json --json")
    assert status == 3
    assert json.loads(out)["fast.json"]["violations"][0]["unit"] == "rad/s²"


def test_a_game_is_a_trajectory_of_either_arm(hockey: Hockey, match: Path) -> None:
    assert hockey(f"export {match} --format ros2 --side away --quiet") == (0, "", "")
    trajectory = read_trajectory(Path("match-ros2/0-away-0.json"))
    assert trajectory.position.shape == (60, 7)


@pytest.mark.parametrize(
    ("content", "named"),
    [
        (None, "there is no file"),
        ("", "'time_from_start'"),
        ("time_from_start,a.position\n", "'a.velocity'"),
        ("time_from_start,a.position,a.velocity,a.acceleration\n", "no points"),
        ("time_from_start,a.position,a.velocity,a.acceleration\n0,1,2,nan\n", "not finite"),
        ("time_from_start,a.position,a.velocity,a.acceleration\n0,1,2,3\n", "has 1 joints; the arms have 3 or 7"),
        ("time_from_start,a.position,a.velocity,a.acceleration\n0,1,two,3\n", "two"),
        ('{"points": []}', "'joint_names'"),
        ("{", "cannot read"),
    ],
)
def test_what_is_no_trajectory_is_told_in_a_line(hockey: Hockey, content: str | None, named: str) -> None:
    if content is not None:
        Path("file").write_text(content)
    status, out, err = hockey("check-trajectory file")
    assert (status, out) == (2, "")
    assert named in err
    assert err.count("\n") == 1


def test_time_goes_forward(hockey: Hockey) -> None:
    trajectory = resting()
    trajectory.time[2] = 0.01
    Path("back.csv").write_text(as_csv(trajectory))
    status, _, err = hockey("check-trajectory back.csv")
    assert status == 2 and "time does not go forward from point 1" in err
