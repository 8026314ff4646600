"""The files that an official evaluation leaves.

official/<env>/dataset.pkl              list of (state, action, reward, next_state, absorbing, last)
official/<env>/computation_time.npy     of draw_action at every step, in [s]
official/<env>/<constraint>.npy         its value at every step, violated where > 0
official/<env>/violations.json          constraint -> number of episodes that violated it
official/results.json                   success, penalty and class of every task; the whole's where a phase is complete
"""

import pickle
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from airhockey.evaluator.runs import trajectories
from airhockey.evaluator.runs.disk import disk_errors, replace_file
from airhockey.evaluator.runs.records import RunResult, TaskResult
from airhockey.evaluator.runs.trajectories import TRAJECTORIES

Transition = tuple[Any, Any, float, Any, bool, bool]


class _Streamed:
    """Pickles as a list of what an iterator gives, without holding the list."""

    def __init__(self, items: Iterator[Transition]) -> None:
        self.items = items

    def __reduce__(self) -> tuple[Any, ...]:
        return list, (), None, self.items


def write_official(path: Path, result: TaskResult | RunResult) -> Path:
    """Write the official files of a finished run.

    Args:
        path: The run folder.
        result: Its result.

    Returns:
        The folder of the official files.

    Raises:
        AirHockeyError: The disk is full or gone; what is there is not all, and is written again on the next call.
    """
    official = path / "official"
    with disk_errors(path):
        for task in result.tasks:
            _write_task(path / TRAJECTORIES, official / task.env, task)
        _write_json(official / "results.json", _results(result))
    return official


def _write_task(source: Path, folder: Path, task: TaskResult) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "dataset.pkl").open("wb") as file:
        pickler = pickle.Pickler(file, protocol=4)
        pickler.fast = True  # no memo: it would hold every array until the end
        pickler.dump(_Streamed(_transitions(source, task.env)))
    np.save(folder / "computation_time.npy", trajectories.read_steps(source, task.env, "computation_time"))
    for name in task.violations:
        np.save(folder / f"{name}.npy", trajectories.read_steps(source, task.env, f"constraints/{name}"))
    _write_json(folder / "violations.json", task.violations)


def _transitions(source: Path, env: str) -> Iterator[Transition]:
    """Every step, in order; the last of an episode is marked, and so is the one that a task ended."""
    for episode in trajectories.read_episodes(source, env):
        record, arrays = episode.record, episode.trajectory
        for step in range(record.steps):
            last = step == record.steps - 1
            yield (
                arrays["observations"][step],
                arrays["actions"][step],
                float(arrays["rewards"][step]),
                arrays["observations"][step + 1],
                last and record.absorbing,
                last,
            )


def _results(result: TaskResult | RunResult) -> dict[str, Any]:
    results: dict[str, Any] = {
        task.env: {
            "success": task.success,
            "penalty": task.penalty,
            "deployability": task.deployability,
            "violations": task.violations,
        }
        for task in result.tasks
    }
    if isinstance(result, RunResult):
        results["overall"] = {"deployability": result.deployability, "phase": result.phase, "score": result.score}
    return results


def _write_json(path: Path, content: Any) -> None:
    replace_file(path, msgspec.json.format(msgspec.json.encode(content), indent=2) + b"\n")
