"""Episodes in HDF5: a few long arrays per environment, and a table that says which rows are whose.

    /<env>/episodes              table: index, first_step, steps, first_observation, success, absorbing
    /<env>/records               the episodes' records as JSON, in the table's order
    /<env>/observations          episode below episode: one more than it has steps, none where that is 0
    /<env>/true_observations     without disturbances; absent where nothing disturbs them
    /<env>/actions, rewards, computation_time, constraints/<name>      a row per step; absent where no step was played

`read_episode(path, env, index)` gives one episode's arrays.
"""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import h5py
import msgspec
import numpy as np
from numpy.typing import NDArray

from airhockey.errors import ConfigurationError
from airhockey.evaluator.runs.disk import new_hdf5, opened_hdf5
from airhockey.evaluator.runs.records import Episode, EpisodeRecord, Trajectory

TRAJECTORIES = "trajectories.h5"  # the file of a finished run
PER_OBSERVATION = ("observations", "true_observations")
CHUNK_ROWS = 1024
TABLE = np.dtype(
    [
        ("index", "i8"),
        ("first_step", "i8"),
        ("steps", "i8"),
        ("first_observation", "i8"),
        ("success", "?"),
        ("absorbing", "?"),
    ]
)


def write(path: Path, episodes: Iterable[Episode]) -> None:
    """Write a file of some episodes, in the order given."""
    by_env: dict[str, list[Episode]] = {}
    for episode in episodes:
        by_env.setdefault(episode.record.env, []).append(episode)
    with new_hdf5(path) as file:
        for env, played in by_env.items():
            group = file.create_group(env)
            group["episodes"] = _table(played)
            group["records"] = [msgspec.json.encode(episode.record) for episode in played]
            trajectories = [episode.trajectory for episode in played if episode.record.steps]
            for name in trajectories[0] if trajectories else ():
                group[name] = np.concatenate([trajectory[name] for trajectory in trajectories])


def merge(sources: Iterable[Path], target: Path) -> None:
    """Make one file of many; its tables are in the order of the episodes' indices.

    Args:
        sources: Files written by `write`, no episode in two of them.
        target: Written beside its place first, then put there.
    """
    sources = list(sources)
    with new_hdf5(target, sum(source.stat().st_size for source in sources)) as merged:
        for source in sources:
            with opened_hdf5(source) as file:
                for env in file:
                    _append_group(merged.require_group(env), file[env])
        for group in merged.values():
            order = np.argsort(group["episodes"]["index"])
            for name in ("episodes", "records"):
                group[name][...] = group[name][()][order]


def read_records(path: Path) -> list[EpisodeRecord]:
    """The records of every episode in a file.

    Raises:
        OSError, KeyError: The file is broken.
    """
    with opened_hdf5(path) as file:
        lines = [line for group in file.values() for line in group["records"][()]]
    return [msgspec.json.decode(line, type=EpisodeRecord) for line in lines]


def read_episodes(path: Path, env: str) -> Iterator[Episode]:
    """Every episode of an environment, one at a time, in the order of their indices."""
    with opened_hdf5(path) as file:
        group = file[env]
        for row, line in zip(group["episodes"][()], group["records"][()], strict=True):
            yield Episode(msgspec.json.decode(line, type=EpisodeRecord), _trajectory(group, row))


def read_episode(path: Path, env: str, index: int) -> Trajectory:
    """One episode's arrays by name.

    Raises:
        ConfigurationError: The file has no such episode.
    """
    with opened_hdf5(path) as file:
        for row in file[env]["episodes"][()] if env in file else ():
            if row["index"] == index:
                return _trajectory(file[env], row)
    raise ConfigurationError(f"{str(path)!r} holds no episode {index} of {env!r}")


def read_steps(path: Path, env: str, name: str) -> NDArray[np.float64]:
    """An array that has a row per step, over all episodes of an environment in the order of their indices.

    Returns:
        Shape (steps, …); empty where no step was played.
    """
    with opened_hdf5(path) as file:
        if name not in file[env]:
            return np.empty(0)
        table = file[env]["episodes"][()]
        rows = [np.arange(row["first_step"], row["first_step"] + row["steps"]) for row in table]
        return np.asarray(file[env][name][()][np.concatenate(rows)])


def _table(episodes: Iterable[Episode]) -> NDArray[Any]:
    rows, first_step, first_observation = [], 0, 0
    for episode in episodes:
        record = episode.record
        rows.append((record.index, first_step, record.steps, first_observation, record.success, record.absorbing))
        first_step += record.steps
        first_observation += record.steps + 1 if record.steps else 0
    return np.array(rows, dtype=TABLE)


def _append_group(target: Any, source: Any) -> None:
    """Append one environment's episodes to those that are already there."""
    table = source["episodes"][()]
    table["first_step"] += _length(target, "rewards")
    table["first_observation"] += _length(target, "observations")
    _append(target, "episodes", table)
    for name in ("records", *_arrays(source)):
        _append(target, name, source[name][()])


def _append(group: Any, name: str, data: NDArray[Any]) -> None:
    if name not in group:
        chunk = (CHUNK_ROWS, *data.shape[1:])
        dtype = h5py.string_dtype() if name == "records" else data.dtype
        group.create_dataset(name, data=data, dtype=dtype, maxshape=(None, *data.shape[1:]), chunks=chunk)
        return
    array = group[name]
    array.resize(len(array) + len(data), axis=0)
    array[-len(data) :] = data


def _length(group: Any, name: str) -> int:
    return len(group[name]) if name in group else 0


def _arrays(group: Any) -> list[str]:
    """Names of the arrays, "constraints/<name>" included."""
    constraints = [f"constraints/{name}" for name in group.get("constraints", ())]
    return [name for name in group if name not in ("episodes", "records", "constraints")] + constraints


def _trajectory(group: Any, row: Any) -> Trajectory:
    """The arrays of the episode that a row of the table stands for."""
    steps = slice(row["first_step"], row["first_step"] + row["steps"])
    count = row["steps"] + 1 if row["steps"] else 0
    observations = slice(row["first_observation"], row["first_observation"] + count)
    return {name: group[name][observations if name in PER_OBSERVATION else steps] for name in _arrays(group)}
