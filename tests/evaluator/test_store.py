from pathlib import Path

import numpy as np
import pytest

from airhockey.envs.disturbances import load_disturbances
from airhockey.errors import AirHockeyError, ConfigurationError
from airhockey.evaluator.play.episode import failed
from airhockey.evaluator.runs import episode_folder as store
from airhockey.evaluator.runs.episode_folder import EpisodeFolder
from airhockey.evaluator.runs.journal import read_journal
from airhockey.evaluator.runs.manifest import Manifest
from airhockey.evaluator.runs.records import Episode, EpisodeRecord, Job, Options
from airhockey.evaluator.runs.trajectories import read_episode, read_episodes, read_steps

MANIFEST = Manifest(
    options=Options(environments=("7dof-hit",)), profile=load_disturbances("ideal"), versions={}, created="now"
)


def episode(index: int, env: str = "7dof-hit") -> Episode:
    """An episode whose every number tells where it belongs."""
    steps = 2 + index % 3
    row = np.arange(steps + 1)[:, None] + 100 * index
    arrays = {
        "observations": row + np.array([0.0, 0.25]),
        "actions": np.broadcast_to(row[:steps, None], (steps, 2, 3)) + 0.5,
        "rewards": row[:steps, 0] + 0.75,
        "computation_time": row[:steps, 0] * 1e-6,
        "constraints/ee_constr": row[:steps] - 0.5,
    }
    return Episode(EpisodeRecord(env=env, index=index, success=index % 2 == 0, steps=steps), arrays)


def same(trajectory: dict, expected: dict) -> bool:
    return trajectory.keys() == expected.keys() and all(
        np.array_equal(trajectory[name], expected[name]) for name in expected
    )


@pytest.fixture
def folder(tmp_path: Path) -> EpisodeFolder:
    return EpisodeFolder.create(tmp_path / "run", MANIFEST)


def fill(folder: EpisodeFolder, *indices: int) -> Path:
    """Each index in a segment of its own."""
    with folder:
        for index in indices:
            folder.add(episode(index))
            folder.flush()
    return folder.path


def test_what_was_added_is_read_back_in_order(folder: EpisodeFolder) -> None:
    with folder:
        for index in (4, 0, 11, 2):
            folder.add(episode(index))
        folder.add(episode(1, "7dof-defend"))
        folder.flush()
        folder.add(episode(3))
        folder.merge()
        folder.merge()  # nothing to do
    file = folder.path / "trajectories.h5"
    for read, index in zip(read_episodes(file, "7dof-hit"), (0, 2, 3, 4, 11), strict=True):
        assert read.record == episode(index).record
        assert same(read.trajectory, episode(index).trajectory)
    assert same(read_episode(file, "7dof-defend", 1), episode(1).trajectory)
    rewards = [episode(index).trajectory["rewards"] for index in (0, 2, 3, 4, 11)]
    assert np.array_equal(read_steps(file, "7dof-hit", "rewards"), np.concatenate(rewards))
    assert not (folder.path / "trajectories").exists()
    with pytest.raises(ConfigurationError, match="no episode 99"):
        read_episode(file, "7dof-hit", 99)


def test_episodes_without_a_step_are_kept_too(folder: EpisodeFolder) -> None:
    with folder:
        for index in range(3):
            folder.add(failed(Job("7dof-hit", index), "no agent", "2023"))
        folder.flush()
        folder.add(episode(3))
        folder.add(failed(Job("7dof-hit", 4), "no agent", "2023"))
        folder.merge()
    read = list(read_episodes(folder.trajectories, "7dof-hit"))
    assert [item.record.error for item in read] == ["no agent"] * 3 + [None, "no agent"]
    assert same(read[3].trajectory, episode(3).trajectory)
    assert all(len(values) == 0 for values in read[4].trajectory.values())


def test_a_run_of_failures_alone_is_kept(folder: EpisodeFolder) -> None:
    with folder:
        folder.add(failed(Job("7dof-hit", 0), "no agent", "2023"))
        folder.merge()
    assert [item.record.error for item in read_episodes(folder.trajectories, "7dof-hit")] == ["no agent"]
    assert read_steps(folder.trajectories, "7dof-hit", "computation_time").size == 0


def test_a_torn_journal_is_mended_from_the_segments(folder: EpisodeFolder) -> None:
    path = fill(folder, 0, 1, 2)
    journal = path / "journal.jsonl"
    journal.write_bytes(journal.read_bytes()[:-30])
    assert len(read_journal(path, EpisodeRecord).records) == 2
    with EpisodeFolder.open(path) as again:
        assert again.done == {Job("7dof-hit", index) for index in range(3)}
    assert read_journal(path, EpisodeRecord).records == [episode(index).record for index in range(3)]


def test_a_line_whose_segment_is_broken_does_not_count(folder: EpisodeFolder) -> None:
    path = fill(folder, 0, 1, 2)
    segment = path / "trajectories" / "000001.h5"
    segment.write_bytes(segment.read_bytes()[:200])
    with EpisodeFolder.open(path) as again:
        assert again.done == {Job("7dof-hit", 0), Job("7dof-hit", 2)}
        again.add(episode(1))
        again.merge()
    assert [item.record.index for item in read_episodes(again.trajectories, "7dof-hit")] == [0, 1, 2]


def test_half_a_segment_never_counts(folder: EpisodeFolder) -> None:
    path = fill(folder, 0)
    (path / "trajectories" / "000001.part").write_bytes(b"half")
    with EpisodeFolder.open(path) as again:
        assert again.done == {Job("7dof-hit", 0)}
        again.add(episode(1))
        again.merge()
    assert [item.record.index for item in read_episodes(again.trajectories, "7dof-hit")] == [0, 1]


def test_killed_between_the_merge_and_the_removal_of_the_segments(
    folder: EpisodeFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = fill(folder, 0, 1)
    monkeypatch.setattr(store.shutil, "rmtree", lambda *_, **__: None)
    with EpisodeFolder.open(path) as killed:
        killed.merge()
    monkeypatch.undo()
    with EpisodeFolder.open(path) as again:
        assert again.done == {Job("7dof-hit", 0), Job("7dof-hit", 1)}
        again.merge()
    assert [item.record.index for item in read_episodes(again.trajectories, "7dof-hit")] == [0, 1]
    assert not (path / "trajectories").exists()


def test_one_process_at_a_time(folder: EpisodeFolder) -> None:
    with pytest.raises(ConfigurationError, match="another process"):
        EpisodeFolder.open(folder.path)
    with folder:
        pass
    with EpisodeFolder.open(folder.path):
        pass


def test_a_folder_that_holds_something_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("precious")
    with pytest.raises(ConfigurationError, match="not empty"):
        EpisodeFolder.create(tmp_path, MANIFEST)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


def test_a_broken_manifest_is_named(tmp_path: Path) -> None:
    (tmp_path / "run.json").write_text("{")
    with pytest.raises(ConfigurationError, match=r"run\.json"):
        EpisodeFolder.open(tmp_path)


def test_a_full_disk_is_one_clear_error(folder: EpisodeFolder, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    fill(folder, 0)
    with EpisodeFolder.open(folder.path) as again:
        monkeypatch.setattr(store.trajectories, "write", full)
        with pytest.raises(AirHockeyError, match="No space left"):
            again.add(episode(1))
        monkeypatch.undo()
    with EpisodeFolder.open(folder.path) as mended:
        assert mended.done == {Job("7dof-hit", 0)}
