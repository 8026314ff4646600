"""LeRobot data sets, format 3.0: Parquet files of frames and episodes beside JSON files that describe them.

    meta/info.json                                what every column is, how many frames there are, 50 frames a second
    meta/stats.json                               minimum, maximum, mean, deviation and quantiles of every column
    meta/tasks.parquet                            the one task, in words
    meta/episodes/chunk-000/file-000.parquet      where each episode's frames are
    data/chunk-000/file-000.parquet               a row per control step

`observation.state` are the joints, `observation.environment_state` is the rest: puck, and opponent where there is one.
"""

import json
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.specs import CONTROL_PERIOD, JOINTS
from airhockey.errors import ConfigurationError
from airhockey.exporting.demonstrations import Demonstration, Demonstrations
from airhockey.exporting.tables import pyarrow

FORMAT = "v3.0"
FRAMES_PER_SECOND = round(1.0 / CONTROL_PERIOD)
EPISODES_PER_FILE = 200
IN_WORDS = {
    "hit": "shoot the puck into the opponent's goal",
    "hit_single": "shoot the puck into the goal",
    "defend": "stop the puck before the goal",
    "prepare": "bring the puck into reach for a shot",
    "tournament": "win a game of air hockey",
}
PUCK = ("puck_x", "puck_y", "puck_yaw", "puck_x_velocity", "puck_y_velocity", "puck_yaw_rate")
TIP = ("opponent_x", "opponent_y", "opponent_z")
QUANTITIES = ("position", "velocity", "acceleration")
QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}
Columns = dict[str, NDArray[Any]]


def write_lerobot(demonstrations: Demonstrations, folder: Path, on_episode: Callable[[], None] = lambda: None) -> Path:
    """Write a data set, with pyarrow alone.

    Args:
        demonstrations: What it is made of.
        folder: The data set's; it is not there, or empty.
        on_episode: Called after every episode.

    Raises:
        ConfigurationError: The folder holds something.
        MissingDependencyError: pyarrow is not installed.
    """
    pyarrow()
    if folder.exists() and any(folder.iterdir()):
        raise ConfigurationError(f"{str(folder)!r} is not empty: choose another -o")
    try:
        _write(demonstrations, folder, on_episode)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    return folder


def _write(demonstrations: Demonstrations, folder: Path, on_episode: Callable[[], None]) -> None:
    summary = _Summary()
    rows: list[dict[str, Any]] = []
    task = IN_WORDS[demonstrations.env.removeprefix("7dof-").removeprefix("3dof-")]
    for number, pieces in enumerate(_batches(demonstrations)):
        parts: list[Columns] = []
        for demonstration in pieces:
            parts.append(_columns(demonstration, len(rows), summary.frames))
            rows.append(_episode_row(demonstration, len(rows), summary.frames, number, task))
            summary.add(parts[-1])
            on_episode()
        _write_frames(folder / f"data/chunk-000/file-{number:03d}.parquet", parts)
    arrow, parquet = pyarrow()
    for path, table in (
        (folder / "meta/episodes/chunk-000/file-000.parquet", arrow.Table.from_pylist(rows)),
        (folder / "meta/tasks.parquet", _tasks(task)),
    ):
        path.parent.mkdir(parents=True, exist_ok=True)
        parquet.write_table(table, path)
    _write_json(folder / "meta/stats.json", summary.statistics())
    _write_json(folder / "meta/info.json", _info(demonstrations, summary, len(rows)))


def _batches(demonstrations: Demonstrations) -> Iterator[Iterator[Demonstration]]:
    """The episodes of one file after the other."""
    for begin in range(0, len(demonstrations), EPISODES_PER_FILE):
        yield map(demonstrations.read, demonstrations.names[begin : begin + EPISODES_PER_FILE])


def _columns(demonstration: Demonstration, number: int, first: int) -> Columns:
    """An episode's frames: what was seen, and what was done then."""
    count, seen = demonstration.steps, demonstration.observations[:-1].astype(np.float32)
    actions = demonstration.actions.reshape(count, -1).astype(np.float32)
    n = _joints(demonstration.actions)
    frame = np.arange(count)
    last = frame == count - 1
    return {
        "observation.state": seen[:, JOINTS : JOINTS + 2 * n],
        "observation.environment_state": np.delete(seen, np.s_[JOINTS : JOINTS + 2 * n], axis=1),
        "action": actions,
        "next.reward": demonstration.rewards.astype(np.float32),
        "next.done": last,
        "next.success": last & demonstration.success,
        "timestamp": (frame / FRAMES_PER_SECOND).astype(np.float32),
        "frame_index": frame,
        "episode_index": np.full(count, number),
        "index": first + frame,
        "task_index": np.zeros(count, dtype=np.int64),
    }


def _joints(actions: NDArray[Any]) -> int:
    return int(actions.shape[-1])


def _episode_row(demonstration: Demonstration, number: int, first: int, file: int, task: str) -> dict[str, Any]:
    return {
        "episode_index": number,
        "tasks": [task],
        "length": demonstration.steps,
        "data/chunk_index": 0,
        "data/file_index": file,
        "dataset_from_index": first,
        "dataset_to_index": first + demonstration.steps,
        "meta/episodes/chunk_index": 0,
        "meta/episodes/file_index": 0,
    }


def _write_frames(path: Path, parts: list[Columns]) -> None:
    arrow, parquet = pyarrow()
    path.parent.mkdir(parents=True, exist_ok=True)
    columns = {}
    for name in parts[0]:
        values = np.concatenate([part[name] for part in parts])
        flat = arrow.array(values.reshape(-1))
        columns[name] = flat if values.ndim == 1 else arrow.FixedSizeListArray.from_arrays(flat, values.shape[1])
    parquet.write_table(arrow.table(columns), path)


def _tasks(task: str) -> Any:
    """A frame of pandas whose index are the tasks' words."""
    arrow, _ = pyarrow()
    index = "__index_level_0__"
    described = [
        {"name": name, "field_name": field, "pandas_type": kind, "numpy_type": numpy, "metadata": None}
        for name, field, kind, numpy in (
            ("task_index", "task_index", "int64", "int64"),
            (None, index, "unicode", "object"),
        )
    ]
    nameless = [{"name": None, "field_name": None, "pandas_type": "unicode", "numpy_type": "object", "metadata": None}]
    pandas = {"index_columns": [index], "column_indexes": nameless, "columns": described, "pandas_version": "2.0.0"}
    table = arrow.table({"task_index": arrow.array([0]), index: arrow.array([task])})
    return table.replace_schema_metadata({"pandas": json.dumps(pandas)})


class _Summary:
    """Gathers what the statistics are made of, in single precision as it is written.

    Attributes:
        frames: So far.
        shapes: Name of a column -> entries and type.
    """

    def __init__(self) -> None:
        self.frames = 0
        self.shapes: dict[str, tuple[int, str]] = {}
        self._values: dict[str, list[NDArray[Any]]] = {}

    def add(self, columns: Columns) -> None:
        """The frames of one more episode."""
        self.frames += len(columns["index"])
        for name, values in columns.items():
            self._values.setdefault(name, []).append(values)
            self.shapes[name] = (1 if values.ndim == 1 else values.shape[1], str(values.dtype))

    def statistics(self) -> dict[str, Any]:
        """Of every column."""
        found = {}
        for name, parts in self._values.items():
            values = np.concatenate(parts).astype(np.float64).reshape(self.frames, -1)
            of_it = {"min": values.min(0), "max": values.max(0), "mean": values.mean(0), "std": values.std(0)}
            of_it |= {key: np.quantile(values, share, axis=0) for key, share in QUANTILES.items()}
            found[name] = {key: value.tolist() for key, value in of_it.items()} | {"count": [self.frames]}
        return found


def _info(demonstrations: Demonstrations, summary: _Summary, episodes: int) -> dict[str, Any]:
    n, rows = demonstrations.robot.n_joints, demonstrations.form.rows
    joints = [f"joint_{k}" for k in range(1, n + 1)]
    outside = summary.shapes["observation.environment_state"][0]
    names: dict[str, list[str] | None] = {
        "observation.state": [f"{joint}.{what}" for what in QUANTITIES[:2] for joint in joints],
        "observation.environment_state": [*PUCK, *TIP][:outside],
        "action": _action_names(joints, rows, demonstrations.order),
    }
    return {
        "codebase_version": FORMAT,
        "robot_type": "iiwa_air_hockey" if n == 7 else "planar_air_hockey",
        "total_episodes": episodes,
        "total_frames": summary.frames,
        "total_tasks": 1,
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "fps": FRAMES_PER_SECOND,
        "splits": {"train": f"0:{episodes}"},
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": None,
        "features": {
            name: {"dtype": dtype, "shape": [width], "names": names.get(name)}
            for name, (width, dtype) in summary.shapes.items()
        },
        "airhockey": {
            "env": demonstrations.env,
            "edition": demonstrations.edition,
            "agent": demonstrations.agent,
            "disturbances": demonstrations.disturbances,
            "interpolation_order": demonstrations.order,
            "actions": demonstrations.meaning,
        },
    }


def _action_names(joints: list[str], rows: int, order: int | None) -> list[str]:
    """Row by row, as an action is laid out."""
    if order is None:
        return [f"{joint}.{what}.{k}" for k in range(rows // 3) for what in QUANTITIES for joint in joints]
    return [f"{joint}.{what}" for what in QUANTITIES[:rows] for joint in joints]


def _write_json(path: Path, content: Any) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content, indent=2) + "\n")
