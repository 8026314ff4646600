import json
import pickle
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from airhockey.evaluator import Options, RunResult, TaskResult, begin, evaluate
from airhockey.evaluator.official import write_official
from airhockey.evaluator.runs.journal import read_journal
from airhockey.evaluator.runs.records import EpisodeRecord
from airhockey.evaluator.runs.trajectories import read_episodes


def test_the_official_files_say_what_was_stored(options: Options, tmp_path: Path) -> None:
    run = tmp_path / "run"
    result = evaluate(begin(options, run))
    assert isinstance(result, TaskResult)
    folder = write_official(run, result) / result.env
    episodes = list(read_episodes(run / "trajectories.h5", result.env))
    dataset = pickle.loads((folder / "dataset.pkl").read_bytes())
    assert isinstance(dataset, list)
    assert len(dataset) == sum(episode.record.steps for episode in episodes)
    ends = np.cumsum([episode.record.steps for episode in episodes])
    for number, (state, action, reward, next_state, absorbing, last) in enumerate(dataset):
        assert state.shape == next_state.shape == (12,)
        assert action.shape == (2, 3)
        assert isinstance(reward, float)
        assert last == (number + 1 in ends)
        if last:
            assert absorbing == episodes[int(np.searchsorted(ends, number + 1))].record.absorbing
        else:
            assert not absorbing
            assert np.array_equal(next_state, dataset[number + 1][0])
    assert np.load(folder / "computation_time.npy").shape == (len(dataset),)
    for name, columns in {"joint_pos_constr": 6, "joint_vel_constr": 6, "ee_constr": 5}.items():
        values = np.load(folder / f"{name}.npy")
        assert values.shape == (len(dataset), columns)
        parts = np.split((values > 0).any(axis=1), ends[:-1])
        assert result.violations[name] == sum(bool(part.any()) for part in parts)
        assert [int(part.sum()) for part in parts] == [episode.record.violations[name] for episode in episodes]
    assert json.loads((folder / "violations.json").read_text()) == result.violations
    results = json.loads((folder.parent / "results.json").read_text())
    assert results[result.env]["success"] == result.success


def test_several_tasks_and_the_whole(tmp_path: Path) -> None:
    options = Options(environments=("3dof-hit", "3dof-defend"), agent="hold", episodes=1)
    result = evaluate(begin(options, tmp_path / "run"))
    assert isinstance(result, RunResult)
    folder = write_official(tmp_path / "run", result)
    assert sorted(path.name for path in folder.iterdir()) == ["3dof-defend", "3dof-hit", "results.json"]
    overall = json.loads((folder / "results.json").read_text())["overall"]
    assert overall == {"deployability": "Deployable", "phase": "phase-1", "score": result.score}


def test_a_run_without_a_step(submission: Callable[..., str], tmp_path: Path) -> None:
    options = Options(environments=("3dof-hit",), agent=submission(building="raise OSError"), episodes=2)
    result = evaluate(begin(options, tmp_path / "run"))
    folder = write_official(tmp_path / "run", result)
    assert pickle.loads((folder / "3dof-hit" / "dataset.pkl").read_bytes()) == []
    assert np.load(folder / "3dof-hit" / "computation_time.npy").size == 0
    assert len(read_journal(tmp_path / "run", EpisodeRecord).records) == 2
    assert result.computation_time.max == pytest.approx(0.0)
