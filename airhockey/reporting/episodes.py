"""What the trajectories of a task say, gathered in one pass over its files.

Everything is computed on long arrays, a block of whole episodes at a time, so that memory stays small whatever a run's length.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.compiled import MAX_END_EFFECTOR_Y, MIN_END_EFFECTOR_X
from airhockey.envs.specs import IIWA
from airhockey.evaluator.analysis.contacts import contacts, hits
from airhockey.evaluator.runs.trajectories import read_groups

Array = NDArray[np.float64]
Table = NDArray[Any]
BASE_X = IIWA.base_positions[0][0]
"""World x of the robot frame's origin, in [m]: the same for both robots."""
_BLOCK = 50_000  # steps
_HUGE = 1e9  # beyond it, or not a number: no value of a simulation is


@dataclass(frozen=True)
class Margins:
    """One constraint's values, violated where > 0, in its own unit.

    Attributes:
        per_step: Of the component that is nearest to its limit. Shape (steps,).
        worst: Of every component, the largest of each episode. Shape (episodes, c).
        step, value, place: Of the steps that violate it: since the episode's start, the value, and where the end-effector
            was in world coordinates, in [m]. Shapes (v,), (v,), (v, 2).
    """

    per_step: Array
    worst: Array
    step: NDArray[np.int64]
    value: Array
    place: Array


@dataclass(frozen=True)
class TaskData:
    """A task's trajectories, aggregated; the episodes are in the files' order.

    Attributes:
        index: Of the episodes in their task. Shape (episodes,).
        success: Shape (episodes,).
        start: The puck at the start, x, y, yaw and their rates in world coordinates. Shape (episodes, 6).
        margins: By the constraint's name.
        hit_speed: Of the puck right after each hit, in [m/s]. Shape (hits,).
        hit_success: Whether the hit's episode was a success. Shape (hits,).
        times: Of `draw_action`, in [s]. Shape (steps,).
    """

    index: NDArray[np.int64]
    success: NDArray[np.bool_]
    start: Array
    margins: dict[str, Margins]
    hit_speed: Array
    hit_success: NDArray[np.bool_]
    times: Array


def read_task(files: Sequence[Path], env: str) -> TaskData | None:
    """Aggregate the trajectories of one environment; None where no step of it was played.

    Raises:
        OSError, KeyError: A file is broken.
    """
    parts = [part for file in files for part in _read_file(file, env)]
    return _joined(parts) if parts else None


def _read_file(path: Path, env: str) -> Iterator[TaskData]:
    for group in read_groups(path, env):
        if "rewards" not in group:
            continue
        table = np.sort(group["episodes"][()], order="first_step")
        for block in _blocks(table[table["steps"] > 0]):
            yield _read_block(group, block)


def _blocks(table: Table) -> Iterator[Table]:
    """Episodes that follow each other in the file, about `_BLOCK` steps of them."""
    number = np.cumsum(table["steps"]) // _BLOCK
    yield from np.split(table, np.flatnonzero(np.diff(number)) + 1)


def _read_block(group: Any, table: Table) -> TaskData:
    steps = slice(int(table["first_step"][0]), int(table["first_step"][-1] + table["steps"][-1]))
    firsts = table["first_step"] - steps.start
    seen = "true_observations" if "true_observations" in group else "observations"
    puck_before, puck_after, start = _puck(group[seen], table)
    constraints = {name: group["constraints"][name][steps] for name in group.get("constraints", ())}
    times = group["computation_time"][steps]
    for values in (puck_before, puck_after, times, *constraints.values()):
        if not (np.abs(values) < _HUGE).all():
            raise ValueError("it holds values that no simulation gave")
    mallet = _end_effector(constraints.get("ee_constr"), steps.stop - steps.start)
    since_start = np.arange(steps.stop - steps.start) - np.repeat(firsts, table["steps"])
    ends = _hits(puck_before, puck_after, mallet, since_start == 0)
    return TaskData(
        index=table["index"],
        success=table["success"],
        start=start,
        margins={name: _margins(values, firsts, since_start, mallet) for name, values in constraints.items()},
        hit_speed=np.linalg.norm(puck_after[ends, 3:5], axis=1),
        hit_success=np.repeat(table["success"], table["steps"])[ends],
        times=times,
    )


def _puck(observations: Any, table: Table) -> tuple[Array, Array, Array]:
    """The puck's true state in world coordinates before and after every step, and at the start of every episode."""
    first = int(table["first_observation"][0])
    rows = observations[first : int(table["first_observation"][-1] + table["steps"][-1]) + 1, :6]
    rows[:, 0] += BASE_X
    starts = table["first_observation"] - first
    is_start, is_end = np.zeros(len(rows), dtype=bool), np.zeros(len(rows), dtype=bool)
    is_start[starts], is_end[starts + table["steps"]] = True, True
    return rows[~is_end], rows[~is_start], rows[starts]


def _end_effector(values: Array | None, steps: int) -> Array:
    """Where the end-effector was at the end of every step, read off its constraint, in world coordinates. Shape (steps, 2)."""
    if values is None:
        return np.full((steps, 2), np.nan)
    return np.stack([BASE_X + MIN_END_EFFECTOR_X - values[:, 0], values[:, 2] + MAX_END_EFFECTOR_Y], axis=1)


def _hits(before: Array, after: Array, mallet: Array, is_first: NDArray[np.bool_]) -> NDArray[np.int64]:
    """The last steps of all hits; where the mallet was at the start of an episode is not known but hardly differs."""
    mallet_before = np.roll(mallet, 1, axis=0)
    mallet_before[is_first] = mallet[is_first]
    return hits(contacts(before, after, mallet_before, mallet), is_first)[:, 1]


def _margins(values: Array, firsts: NDArray[np.int64], since_start: NDArray[np.int64], mallet: Array) -> Margins:
    per_step = values.max(axis=1)
    violating = np.flatnonzero(per_step > 0.0)
    return Margins(
        per_step=per_step,
        worst=np.maximum.reduceat(values, firsts, axis=0),
        step=since_start[violating] + 1,
        value=per_step[violating],
        place=mallet[violating],
    )


def _joined(parts: Sequence[TaskData]) -> TaskData:
    names = list(dict.fromkeys(name for part in parts for name in part.margins))
    return TaskData(
        index=_rows(part.index for part in parts),
        success=_rows(part.success for part in parts),
        start=_rows(part.start for part in parts),
        margins={
            name: _joined_margins([part.margins[name] for part in parts if name in part.margins]) for name in names
        },
        hit_speed=_rows(part.hit_speed for part in parts),
        hit_success=_rows(part.hit_success for part in parts),
        times=_rows(part.times for part in parts),
    )


def _joined_margins(parts: Sequence[Margins]) -> Margins:
    return Margins(
        per_step=_rows(part.per_step for part in parts),
        worst=_rows(part.worst for part in parts),
        step=_rows(part.step for part in parts),
        value=_rows(part.value for part in parts),
        place=_rows(part.place for part in parts),
    )


def _rows(arrays: Iterable[NDArray[Any]]) -> NDArray[Any]:
    return np.concatenate(list(arrays))
