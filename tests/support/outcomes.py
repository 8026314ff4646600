"""What of a run must not depend on how it was played."""

from pathlib import Path
from typing import Any

from airhockey.evaluator.runs.records import Episode
from airhockey.evaluator.runs.trajectories import read_episodes

ENV = "3dof-defend"  # its episodes are short


def outcome(folder: Path, env: str = ENV) -> list[tuple[Any, ...]]:
    """Everything about a finished run's episodes but the time that they took, in order."""
    return [without_time(episode) for episode in read_episodes(folder / "trajectories.h5", env)]


def without_time(episode: Episode) -> tuple[Any, ...]:
    """What of an episode must be the same however it is played, bit for bit."""
    record = episode.record
    arrays = {name: values.tobytes() for name, values in episode.trajectory.items() if name != "computation_time"}
    return record.index, record.success, record.steps, record.absorbing, record.violations, record.error, arrays
