"""Data sets of recorded runs and games: what their own readers find in them is what was played."""

import csv
import json
import os
from pathlib import Path

import minari
import numpy as np
import pytest
from command_line import Hockey
from pyarrow import parquet

from airhockey import envs
from airhockey.evaluator.runs.reader import Games, Run, open_source
from airhockey.evaluator.runs.trajectories import read_episode
from airhockey.exporting.demonstrations import ACHIEVED, in_robot_frame, of_games, of_run

ENV = "7dof-hit"


def played(run: Path, index: int, env: str = ENV) -> dict[str, np.ndarray]:
    return read_episode(run / "trajectories.h5", env, index)


def test_tables_have_a_row_for_every_episode_and_game(hockey: Hockey, run: Path, match: Path) -> None:
    assert hockey(f"export {run} --format csv") == (0, "wrote run.csv (6 rows)\n", "")
    with Path("run.csv").open() as file:
        rows = list(csv.DictReader(file))
    records = open_source(run).records
    assert [(row["env"], int(row["index"]), int(row["steps"])) for row in rows] == [
        (record.env, record.index, record.steps) for record in records
    ]
    assert {row["disturbances"] for row in rows} == {"server"}
    assert hockey(f"export {run} --format parquet -o here.parquet --quiet") == (0, "", "")
    table = parquet.read_table("here.parquet").to_pylist()
    assert [row["success"] for row in table] == [record.success for record in records]
    assert [row["link_constr_steps"] for row in table] == [
        record.violations.get("link_constr", 0) for record in records
    ]
    assert hockey(f"export {match} --format csv --quiet")[0] == 0
    (game,) = csv.DictReader(Path("match.csv").read_text().splitlines())
    assert (game["home"], int(game["steps"]), game["winner"]) == ("h", 60, "draw")


def test_a_minari_data_set_loads_and_makes_its_environment(
    hockey: Hockey, run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    status, out, _ = hockey(f"export {run} --env {ENV} --format minari -o sets")
    assert status == 0
    assert "minari.load_dataset('airhockey/7dof-hit/hold-v0')" in out
    assert "MINARI_DATASETS_PATH" not in os.environ
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(Path("sets").resolve()))
    data = minari.load_dataset("airhockey/7dof-hit/hold-v0")
    assert data.total_episodes == 3
    for index, episode in enumerate(data.iterate_episodes()):
        arrays = played(run, index)
        assert np.array_equal(episode.observations, arrays["observations"])
        assert np.array_equal(episode.actions, arrays["actions"])
        assert data.action_space.contains(episode.actions[0])
        assert (episode.terminations[-1], episode.truncations[-1]) == (False, True)
    made = data.recover_environment()
    assert made.observation_space == data.observation_space
    assert made.unwrapped.environment.disturbances.profile == "server"
    status, out, err = hockey(f"export {run} --env {ENV} --format minari -o sets")
    assert (status, out) == (2, "")
    assert "choose another --name" in err


def test_a_game_is_a_minari_data_set_of_what_one_side_saw(
    hockey: Hockey, match: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert hockey(f"export {match} --side away --format minari --name a-v1 -o sets --quiet") == (0, "", "")
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(Path("sets").resolve()))
    (episode,) = minari.load_dataset("a-v1").iterate_episodes()
    assert episode.observations.shape == (60, 23)
    assert episode.actions.shape == (59, 2, 7)
    assert np.array_equal(episode.actions.reshape(59, 14), episode.observations[1:, 6:20])


def test_a_lerobot_data_set_is_laid_out_as_its_format_wants(hockey: Hockey, run: Path) -> None:
    assert hockey(f"export {run} --env 3dof-hit --format lerobot -o set --quiet") == (0, "", "")
    info = json.loads(Path("set/meta/info.json").read_text())
    assert (info["codebase_version"], info["fps"], info["total_episodes"]) == ("v3.0", 50, 3)
    frames = parquet.read_table("set/data/chunk-000/file-000.parquet")
    assert info["total_frames"] == len(frames)
    columns = {name: np.array(frames[name].to_pylist()) for name in info["features"]}
    for name, feature in info["features"].items():
        assert columns[name].reshape(len(frames), -1).shape[1] == feature["shape"][0]
        assert feature["names"] is None or len(feature["names"]) == feature["shape"][0]
    for episode in parquet.read_table("set/meta/episodes/chunk-000/file-000.parquet").to_pylist():
        part = slice(episode["dataset_from_index"], episode["dataset_to_index"])
        arrays = played(run, episode["episode_index"], "3dof-hit")
        assert np.allclose(columns["action"][part], arrays["actions"].reshape(-1, 6), atol=1e-6)
        assert np.allclose(columns["observation.state"][part], arrays["observations"][:-1, 6:12], atol=1e-6)
        assert np.allclose(columns["observation.environment_state"][part], arrays["observations"][:-1, :6], atol=1e-5)
        assert list(columns["next.done"][part]) == [False] * (episode["length"] - 1) + [True]
    stats = json.loads(Path("set/meta/stats.json").read_text())
    assert np.allclose(stats["action"]["mean"], columns["action"].mean(axis=0), atol=1e-6)
    status, _, err = hockey(f"export {run} --env 3dof-hit --format lerobot -o set")
    assert status == 2 and "not empty" in err


@pytest.mark.long
def test_lerobots_own_reader_reads_it(hockey: Hockey, run: Path) -> None:
    datasets = pytest.importorskip("lerobot.datasets.lerobot_dataset", reason="pip install lerobot")
    assert hockey(f"export {run} --env {ENV} --format lerobot -o set --quiet") == (0, "", "")
    data = datasets.LeRobotDataset("set", root="set", delta_timestamps={"action": [0.0, 0.02]})
    assert data.num_episodes == 3
    assert data[0]["action"].shape == (2, 14)


def test_a_game_is_seen_as_the_environment_shows_it() -> None:
    env = envs.make("tournament")
    rows, seen = [], []
    for seed in range(4):
        env.reset(seed=seed)
        for k in range(5):
            where = np.stack((env.true_observation[6:13] + 0.02 * k, np.ones(7)))
            env.step((where, -where))
            rows.append(env.base_observation)
            seen.append(env.true_observation.reshape(2, 23))
    for side in range(2):
        assert np.allclose(in_robot_frame(np.array(rows), side), np.array(seen)[:, side], atol=1e-12)


def test_a_game_is_a_piece_for_every_serve(match: Path) -> None:
    source = open_source(match)
    assert isinstance(source, Games)
    games = of_games(source, "home")
    assert (games.meaning, games.names) == (ACHIEVED, ["0/home/0"])
    (piece,) = games
    assert piece.rewards.sum() == 0.0
    assert not piece.terminated


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ("export nowhere --format csv", "there is no such folder"),
        ("export {run} --format lerobot", "3dof-hit, 7dof-hit"),
        ("export {run} --format lerobot --env 7dof-defend", "allowed: 3dof-hit, 7dof-hit"),
        ("export {run} --format ros2 --env 7dof-hit --episodes 9", "there are 0, 1, 2"),
        ("export {run} --format minari --env 7dof-hit --name ../out", "is no id"),
        ("export {run} --format csv --name a-v0", "--name is the id"),
        ("export {run} --format csv --episodes 1", "leave out --episodes"),
        ("export {run}", "--format"),
        ("export {run} --format xls", "'xls' is not one of"),
    ],
)
def test_what_cannot_be_exported_is_told_in_a_line(hockey: Hockey, run: Path, arguments: str, named: str) -> None:
    status, out, err = hockey(arguments.replace("{run}", str(run)))
    assert (status, out) == (2, "")
    assert named in err
    assert err.count("\n") == 1
    assert not list(Path().iterdir())


def test_failed_episodes_are_shorter_and_no_success(run: Path) -> None:
    source = open_source(run)
    assert isinstance(source, Run)
    demonstrations = of_run(source, ENV)
    assert [len(episode.observations) - episode.steps for episode in demonstrations] == [1, 1, 1]
    assert [bool(episode.rewards[-1]) for episode in demonstrations] == [record.success for record in source.of(ENV)]
