"""What is aggregated from trajectories, against the same taken one episode at a time."""

from pathlib import Path

import numpy as np
import pytest
from results import ENV, EPISODES, Results

from airhockey.envs.kernel.arm import arm_from_model
from airhockey.envs.kernel.kinematics import forward_kinematics
from airhockey.envs.scene import robot_model
from airhockey.envs.specs import PLANAR
from airhockey.evaluator import Options, begin, evaluate
from airhockey.evaluator.runs.trajectories import read_episodes, write
from airhockey.reporting import episodes as module
from airhockey.reporting.episodes import read_task


@pytest.mark.parametrize("block", [1, 100, 50_000])
def test_every_aggregate_is_that_of_the_single_episodes(
    results: Results, block: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_BLOCK", block)
    path = results.swings / "trajectories.h5"
    data = read_task([path], ENV)
    assert data is not None
    played = {episode.record.index: episode for episode in read_episodes(path, ENV) if episode.record.steps}
    assert sorted(data.index) == sorted(played)
    in_order = [played[index] for index in data.index]
    assert data.success.tolist() == [episode.record.success for episode in in_order]
    times = np.concatenate([episode.trajectory["computation_time"] for episode in in_order])
    assert np.array_equal(data.times, times)
    starts = np.array([episode.trajectory["observations"][0, :6] for episode in in_order])
    assert data.start == pytest.approx(starts - np.array([1.51, 0, 0, 0, 0, 0]))
    assert data.margins["ee_constr"].value.size  # or the following would be empty
    for name, margins in data.margins.items():
        values = [episode.trajectory[f"constraints/{name}"] for episode in in_order]
        assert np.array_equal(margins.worst, [value.max(axis=0) for value in values])
        assert np.array_equal(margins.per_step, np.concatenate([value.max(axis=1) for value in values]))
        steps = np.concatenate([np.flatnonzero((value > 0).any(axis=1)) + 1 for value in values])
        assert np.array_equal(margins.step, steps)
        violated = sum(episode.record.violations[name] for episode in in_order)
        assert margins.value.size == violated == np.count_nonzero(margins.value > 0)


def test_violations_are_placed_where_the_end_effector_was(results: Results) -> None:
    """Against forward kinematics of the joints that were observed."""
    path = results.swings / "trajectories.h5"
    data = read_task([path], ENV)
    assert data is not None
    arm = arm_from_model(PLANAR, robot_model(PLANAR))
    places = []
    for episode in read_episodes(path, ENV):
        for row, values in zip(
            episode.trajectory["observations"][1:], episode.trajectory["constraints/ee_constr"], strict=True
        ):
            if (values > 0).any():
                positions, axes = np.empty((4, 3)), np.empty((5, 3))
                forward_kinematics(arm, row[6:9].copy(), positions, axes)
                places.append(positions[-1, :2] + [-1.51, 0.0])
    assert data.margins["ee_constr"].place == pytest.approx(np.array(places))


def test_segments_say_the_same_as_one_file(results: Results, tmp_path: Path) -> None:
    path = results.swings / "trajectories.h5"
    played = list(read_episodes(path, ENV))
    files = [tmp_path / f"{k}.h5" for k in range(3)]
    for k, file in enumerate(files):
        write(file, played[4 * k : 4 * k + 4])
    whole, parts = read_task([path], ENV), read_task(files, ENV)
    assert whole is not None and parts is not None
    assert parts.index.tolist() == whole.index.tolist() == list(range(EPISODES))
    assert np.array_equal(parts.hit_speed, whole.hit_speed)
    assert np.array_equal(parts.margins["ee_constr"].worst, whole.margins["ee_constr"].worst)


def test_nothing_is_read_of_what_was_not_played(results: Results) -> None:
    assert read_task([results.swings / "trajectories.h5"], "7dof-hit") is None
    assert read_task([], ENV) is None


def test_the_hit_that_scores_is_found_with_its_speed(tmp_path: Path) -> None:
    """An episode that an agent of ours wins: the puck leaves its mallet with the speed that it has a step later."""
    run = begin(Options(environments=("3dof-hit",), agent="planner", episodes=2, seed=1), tmp_path / "run")
    evaluate(run)
    path = tmp_path / "run" / "trajectories.h5"
    data = read_task([path], "3dof-hit")
    assert data is not None and data.success.all()
    speeds = []
    for episode in read_episodes(path, "3dof-hit"):
        velocity = episode.trajectory["observations"][:, 3:5]
        at_rest = np.linalg.norm(velocity, axis=1) < 1e-6
        speeds.append(np.linalg.norm(velocity[~at_rest], axis=1).max())
    assert data.hit_speed.max() == pytest.approx(max(speeds), rel=0.05)
    assert len(data.index) <= len(data.hit_speed) <= 3 * len(data.index)
