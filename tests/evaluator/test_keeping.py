"""What a run keeps of its trajectories, and what is computed again when it is read."""

import json
from pathlib import Path

import h5py
import msgspec
import numpy as np
import pytest
from command_line import Hockey

from airhockey.errors import ConfigurationError
from airhockey.evaluator import Options, begin, evaluate, evaluation
from airhockey.evaluator.official import write_official
from airhockey.evaluator.runs.reader import Run, open_source
from airhockey.evaluator.runs.trajectories import BLOCK, read_episode, read_episodes, read_steps
from airhockey.reporting.episodes import read_task

ENV = "3dof-defend"
WHOLE = Options(environments=(ENV,), agent="hold", episodes=5, seed=1 << 70, disturbances="harsh")
TIME = "computation_time"


def play(path: Path, keep: str | None = None, options: Options = WHOLE) -> Path:
    kept = options if keep is None else msgspec.structs.replace(options, keep=keep)
    evaluate(begin(kept, path))
    return path / "trajectories.h5"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return play(tmp_path_factory.mktemp("kept") / "whole")


@pytest.fixture(scope="module")
def actions(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return play(tmp_path_factory.mktemp("kept") / "actions", "actions")


def test_all_follows_from_the_actions_to_the_bit(whole: Path, actions: Path) -> None:
    with h5py.File(actions) as file:
        assert set(file[ENV]) == {"actions", TIME, "checksums", "episodes", "records"}
    for one, other in zip(read_episodes(whole, ENV), read_episodes(actions, ENV), strict=True):
        assert one.trajectory.keys() == other.trajectory.keys() > {"true_observations", "constraints/ee_constr"}
        for name in one.trajectory.keys() - {TIME}:
            assert one.trajectory[name].tobytes() == other.trajectory[name].tobytes()
    alone = read_episode(actions, ENV, 3)
    assert np.array_equal(alone["observations"], read_episode(whole, ENV, 3)["observations"])
    for name in ("constraints/ee_constr", "actions"):
        assert np.array_equal(read_steps(whole, ENV, name), read_steps(actions, ENV, name))


@pytest.mark.parametrize("order", [1, "none"])
def test_actions_of_every_order_are_enough(tmp_path: Path, order: int | str) -> None:
    options = msgspec.structs.replace(WHOLE, episodes=1, interpolation_order=order)
    one, other = (read_episode(play(tmp_path / str(keep), keep, options), ENV, 0) for keep in (None, "actions"))
    assert one["observations"].tobytes() == other["observations"].tobytes()


def test_segments_of_a_run_that_goes_on_are_one_file(tmp_path: Path, whole: Path) -> None:
    folder = begin(msgspec.structs.replace(WHOLE, keep="actions"), tmp_path / "run")
    for index in (4, 0, 2):
        folder.add(evaluation.play_episode(WHOLE, ENV, index))
        folder.flush()
    folder.close()
    assert isinstance(source := open_source(tmp_path / "run"), Run)
    assert len(source.stored) == 3
    evaluate(evaluation.resume(tmp_path / "run", {"trajectories": "actions"}))
    for index in range(5):
        again = read_episode(tmp_path / "run" / "trajectories.h5", ENV, index)
        assert again["observations"].tobytes() == read_episode(whole, ENV, index)["observations"].tobytes()


def test_reports_and_official_files_are_the_same(whole: Path, actions: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("airhockey.evaluator.runs.trajectories.BLOCK", BLOCK // 200)  # several pieces
    one, other = read_task([whole], ENV), read_task([actions], ENV)
    assert one is not None and other is not None
    assert np.array_equal(one.start, other.start) and np.array_equal(one.hit_speed, other.hit_speed)
    assert np.array_equal(one.margins["ee_constr"].worst, other.margins["ee_constr"].worst)
    files = [write_official(path.parent, evaluation.report(path.parent)) / ENV for path in (whole, actions)]
    assert len({(folder / "ee_constr.npy").read_bytes() for folder in files}) == 1
    assert len({(folder / "dataset.pkl").stat().st_size for folder in files}) == 1


def test_what_comes_out_otherwise_is_refused(actions: Path, tmp_path: Path) -> None:
    spoilt = tmp_path / "trajectories.h5"
    spoilt.write_bytes(actions.read_bytes())
    with h5py.File(spoilt, "a") as file:
        file[ENV]["actions"][3] += 1e-12
    with pytest.raises(ConfigurationError, match="they lead to another episode; it was played with airhockey"):
        read_episode(spoilt, ENV, 0)
    assert read_episode(spoilt, ENV, 1)


def test_nothing_but_times_is_kept(tmp_path: Path, hockey: Hockey) -> None:
    file = play(tmp_path / "run", "none")
    with h5py.File(file) as content:
        assert set(content[ENV]) == {TIME, "episodes", "records"}
    source = open_source(tmp_path / "run")
    assert isinstance(source, Run)
    assert (len(source.records), source.stored) == (5, {})
    assert json.loads((tmp_path / "run" / "result.json").read_text())[TIME]["mean"] > 0.0
    status, out, err = hockey(f"replay {tmp_path / 'run'}")
    assert (status, out) == (2, "") and "--trajectories none" in err
    status, _, err = hockey(f"report {tmp_path / 'run'} --quiet")
    assert status == 0 and "--trajectories none" in err
    assert hockey(f"failures {tmp_path / 'run'}")[0] == 0


def test_manifests_that_keep_all_do_not_mention_it(whole: Path, actions: Path) -> None:
    assert "trajectories" not in json.loads((whole.parent / "run.json").read_text())["options"]
    assert json.loads((actions.parent / "run.json").read_text())["options"]["trajectories"] == "actions"


def test_a_run_keeps_what_it_began_to_keep(hockey: Hockey, actions: Path) -> None:
    status, _, err = hockey(f"evaluate --resume --out {actions.parent} --trajectories full --quiet")
    assert status == 2 and "has trajectories 'actions', not 'full'" in err
    assert hockey(f"evaluate --resume --out {actions.parent} --quiet")[0] == 0
    status, _, err = hockey("evaluate --official-dataset --trajectories none")
    assert status == 2 and "--trajectories full or actions" in err


def test_packed_arrays_are_smaller_and_kept_actions_smallest(whole: Path, actions: Path) -> None:
    with h5py.File(whole) as file:
        assert file[ENV]["observations"].compression == "gzip"
    assert 2 * actions.stat().st_size < whole.stat().st_size
