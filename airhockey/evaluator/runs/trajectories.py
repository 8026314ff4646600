"""Episodes in HDF5: a few long arrays per environment, and a table that says which rows are whose.

    /<env>/episodes              table: index, first_step, steps, first_observation, success, absorbing
    /<env>/records               the episodes' records as JSON, in the table's order
    /<env>/observations          episode below episode: one more than it has steps, none where that is 0
    /<env>/true_observations     without disturbances; absent where nothing disturbs them
    /<env>/actions, rewards, computation_time, constraints/<name>      a row per step; absent where no step was played
    /<env>/checksums             of every episode; only where its actions are kept and the rest is computed from them

Observations, rewards and constraints are absent where a run kept its actions alone (see `keeping`): who reads them here gets them
computed again. Where a run kept no trajectories, computation times are all that there is.

`read_episode(path, env, index)` gives one episode's arrays.
"""

import io
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import h5py
import msgspec
import numpy as np
from numpy.typing import NDArray

from airhockey.errors import ConfigurationError
from airhockey.evaluator.runs import keeping
from airhockey.evaluator.runs.disk import new_hdf5, opened_hdf5
from airhockey.evaluator.runs.keeping import ACTIONS, FULL, KEPT, NONE, Keep, Recipe
from airhockey.evaluator.runs.records import Episode, EpisodeRecord, Trajectory

TRAJECTORIES = "trajectories.h5"  # the file of a finished run
PER_OBSERVATION = ("observations", "true_observations")
NOT_ARRAYS = ("episodes", "records", "constraints", "checksums")
PER_EPISODE = ("episodes", "records", "checksums")
CHUNK_ROWS = 1024
BLOCK = 50_000
"""Steps that are computed again at a time, where everything is read."""
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


def write(path: Path, episodes: Iterable[Episode], keep: Keep = FULL, recipe: Recipe | None = None) -> None:
    """Write a file of some episodes, in the order given.

    Args:
        path: The file.
        episodes: Whole, whatever is kept of them.
        keep: What is written.
        recipe: What the rest is computed from, where actions are kept.
    """
    by_env: dict[str, list[Episode]] = {}
    for episode in episodes:
        by_env.setdefault(episode.record.env, []).append(episode)
    with new_hdf5(path) as file:
        for env, played in by_env.items():
            _write_group(file.create_group(env), played, keep, recipe)


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
            for name in filter(group.__contains__, PER_EPISODE):
                group[name][...] = group[name][()][order]


def read_records(path: Path) -> list[EpisodeRecord]:
    """The records of every episode in a file.

    Raises:
        OSError, KeyError: The file is broken.
    """
    with opened_hdf5(path) as file:
        return [record for group in file.values() for record in _records(group)]


def kept_in(path: Path) -> Keep:
    """What a file keeps of its episodes."""
    with opened_hdf5(path) as file:
        return next((_keep(group) for group in file.values()), FULL)


def read_episodes(path: Path, env: str) -> Iterator[Episode]:
    """Every episode of an environment, one at a time, in the order of their indices."""
    with opened_hdf5(path) as file:
        yield from _episodes(file[env])


def read_episode(path: Path, env: str, index: int) -> Trajectory:
    """One episode's arrays by name.

    Raises:
        ConfigurationError: The file has no such episode, or its actions lead elsewhere on this machine.
    """
    with opened_hdf5(path) as file:
        rows = file[env]["episodes"][()] if env in file else np.empty(0, TABLE)
        for number in np.flatnonzero(rows["index"] == index):
            return _trajectory(file[env], rows, int(number))
    raise ConfigurationError(f"{str(path)!r} holds no episode {index} of {env!r}")


def read_steps(path: Path, env: str, name: str) -> NDArray[np.float64]:
    """An array that has a row per step, over all episodes of an environment in the order of their indices.

    Returns:
        Shape (steps, …); empty where no step was played, or no such array was kept.
    """
    with opened_hdf5(path) as file:
        group = file[env]
        if name in group:
            table = group["episodes"][()]
            rows = [np.arange(row["first_step"], row["first_step"] + row["steps"]) for row in table]
            return np.asarray(group[name][()][np.concatenate(rows)])
        if _keep(group) != ACTIONS:
            return np.empty(0)
        parts = [episode.trajectory[name] for episode in _episodes(group) if episode.record.steps]
        return np.concatenate(parts) if parts else np.empty(0)


def read_groups(path: Path, env: str) -> Iterator[Any]:
    """The group of an environment with every array, for those who read long arrays; in pieces where it has to be computed again.

    Nothing where there is no such environment, or no trajectories were kept.
    """
    with opened_hdf5(path) as file:
        group = file.get(env)
        keep = NONE if group is None else _keep(group)
        if keep == FULL:
            yield group
        if keep != ACTIONS:
            return
        piece: list[Episode] = []
        for episode in _episodes(group):
            piece.append(episode)
            if sum(one.record.steps for one in piece) >= BLOCK:
                yield from _in_memory(piece)
                piece = []
        yield from _in_memory(piece)


def _in_memory(episodes: list[Episode]) -> Iterator[Any]:
    if episodes:
        with h5py.File(io.BytesIO(), "w") as file:
            _write_group(file, episodes, FULL, None)
            yield file


def _write_group(group: Any, episodes: list[Episode], keep: Keep, recipe: Recipe | None) -> None:
    group["episodes"] = _table(episodes)
    group["records"] = [msgspec.json.encode(episode.record) for episode in episodes]
    trajectories = [episode.trajectory for episode in episodes if episode.record.steps]
    names = trajectories[0] if trajectories else ()
    for name in names if keep == FULL else filter(names.__contains__, KEPT[keep]):
        group[name] = np.concatenate([trajectory[name] for trajectory in trajectories])
    if keep != FULL:
        group.attrs["keep"] = keep
    if keep == ACTIONS:
        sums = b"".join(keeping.checksum(episode.trajectory) for episode in episodes)
        group["checksums"] = np.frombuffer(sums, np.uint8).reshape(len(episodes), -1)
        group.attrs["recipe"] = np.void(msgspec.json.encode(recipe))


def _records(group: Any) -> list[EpisodeRecord]:
    return [msgspec.json.decode(line, type=EpisodeRecord) for line in group["records"][()]]


def _keep(group: Any) -> Keep:
    keep = group.attrs.get("keep", FULL)
    if keep not in (FULL, *KEPT):
        raise ValueError(f"it keeps {keep!r} of its episodes, which this version does not know")
    return keep  # type: ignore[no-any-return]


def _episodes(group: Any) -> Iterator[Episode]:
    """All of a group, in its table's order."""
    table = group["episodes"][()]
    for number, record in enumerate(_records(group)):
        yield Episode(record, _trajectory(group, table, number))


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
    table["first_step"] += _length(target, "computation_time")  # which is there whatever is kept
    table["first_observation"] += _length(target, "observations")
    _append(target, "episodes", table)
    for name in ("records", *filter(source.__contains__, ("checksums",)), *_arrays(source)):
        _append(target, name, source[name][()])
    target.attrs.update(source.attrs)


def _append(group: Any, name: str, data: NDArray[Any]) -> None:
    if name not in group:
        chunk = (CHUNK_ROWS, *data.shape[1:])
        dtype = h5py.string_dtype() if name == "records" else data.dtype
        packed = {} if name in PER_EPISODE else {"compression": "gzip", "compression_opts": 1, "shuffle": True}
        group.create_dataset(name, data=data, dtype=dtype, maxshape=(None, *data.shape[1:]), chunks=chunk, **packed)
        return
    array = group[name]
    array.resize(len(array) + len(data), axis=0)
    array[-len(data) :] = data


def _length(group: Any, name: str) -> int:
    return len(group[name]) if name in group else 0


def _arrays(group: Any) -> list[str]:
    """Names of the arrays, "constraints/<name>" included."""
    constraints = [f"constraints/{name}" for name in group.get("constraints", ())]
    return [name for name in group if name not in NOT_ARRAYS] + constraints


def _trajectory(group: Any, table: NDArray[Any], number: int) -> Trajectory:
    """The arrays of the episode in a row of the table; those that follow from its actions are computed."""
    row = table[number]
    kept = _stored(group, row)
    if _keep(group) != ACTIONS:
        return kept
    recipe = msgspec.json.decode(group.attrs["recipe"].tobytes(), type=Recipe)
    record = msgspec.json.decode(group["records"][number], type=EpisodeRecord)
    return keeping.replayed(recipe, record, kept, group["checksums"][number].tobytes())


def _stored(group: Any, row: Any) -> Trajectory:
    steps = slice(row["first_step"], row["first_step"] + row["steps"])
    count = row["steps"] + 1 if row["steps"] else 0
    observations = slice(row["first_observation"], row["first_observation"] + count)
    return {name: group[name][observations if name in PER_OBSERVATION else steps] for name in _arrays(group)}
