"""Minari data sets: episodes with spaces and the environment's specification, as `minari.load_dataset` reads them."""

import os
import re
import shutil
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from airhockey import __version__
from airhockey.errors import ConfigurationError
from airhockey.exporting.demonstrations import GAME, Demonstration, Demonstrations
from airhockey.inputs.packages import needs

FOLDER = "MINARI_DATASETS_PATH"
"""The variable by which Minari knows where data sets are."""
ID = re.compile(r"(?:[-\w.]+/){0,2}[-\w.]+-v\d+")


def dataset_id(demonstrations: Demonstrations) -> str:
    """A name for them, as in "airhockey/7dof-hit/planner-v0"."""
    agent = re.sub(r"[^\w.]+", "-", demonstrations.agent).strip("-") or "agent"
    return f"airhockey/{demonstrations.env}/{agent}-v0"


def write_minari(
    demonstrations: Demonstrations, name: str, folder: Path | None, on_episode: Callable[[], None] = lambda: None
) -> Path:
    """Write a data set.

    Args:
        demonstrations: What it is made of.
        name: Its id.
        folder: Where data sets are; Minari's own place for None.
        on_episode: Called after every episode.

    Returns:
        The data set's folder.

    Raises:
        ConfigurationError: The name is none for Minari, or there is such a data set.
        MissingDependencyError: Minari or Gymnasium is not installed.
    """
    minari, spaces = _minari()
    if ID.fullmatch(name) is None:
        raise ConfigurationError(
            f"{name!r} is no id of a Minari data set; give one as in {dataset_id(demonstrations)!r}"
        )
    before = os.environ.get(FOLDER)
    if folder is not None:
        os.environ[FOLDER] = str(folder.resolve())
    path = Path(os.environ.get(FOLDER, Path.home() / ".minari" / "datasets")) / name
    if path.exists():
        raise ConfigurationError(f"there is a data set {name!r} in {str(path)!r}: choose another --name, or delete it")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # of fields that are left empty on purpose
            minari.create_dataset_from_buffers(
                dataset_id=name,
                buffer=_buffers(demonstrations, on_episode),
                algorithm_name=demonstrations.agent,
                description=_description(demonstrations),
                requirements=[f"airhockey[rl]=={__version__}"],
                data_format="hdf5",
                **_environment(demonstrations, spaces),
            )
    except BaseException:
        shutil.rmtree(path, ignore_errors=True)
        raise
    finally:
        if folder is not None:
            os.environ.pop(FOLDER)
            os.environ.update({} if before is None else {FOLDER: before})
    return path


def _minari() -> tuple[Any, Any]:
    with needs("this format", "Minari", "export"):
        import minari
        from gymnasium import spaces
        from minari.data_collector import EpisodeBuffer  # noqa: F401
    return minari, spaces


def _environment(demonstrations: Demonstrations, spaces: Any) -> dict[str, Any]:
    """The specification of the environment, from which it can be made again; the spaces alone for games."""
    if demonstrations.env == GAME:
        first = demonstrations.read(demonstrations.names[0])
        low, high = demonstrations.form.limits(demonstrations.robot)
        return {
            "observation_space": spaces.Box(-np.inf, np.inf, first.observations.shape[1:], np.float64),
            "action_space": spaces.Box(low, high, dtype=np.float64),
        }
    import gymnasium

    from airhockey.envs.gymnasium import NAMESPACES

    task = demonstrations.env
    if demonstrations.edition != "2023":
        task = task.removeprefix("7dof-")
    made = gymnasium.make(
        f"airhockey.envs.gymnasium:{NAMESPACES[demonstrations.edition]}/{task}-v0",
        interpolation_order=demonstrations.order,
        disturbances=demonstrations.disturbances or "ideal",
    )
    return {"env": made}


def _buffers(demonstrations: Demonstrations, on_episode: Callable[[], None]) -> Iterator[Any]:
    from minari.data_collector import EpisodeBuffer

    for number, demonstration in enumerate(demonstrations):
        yield EpisodeBuffer(
            id=number,
            observations=demonstration.observations,
            actions=demonstration.actions,
            rewards=list(demonstration.rewards),
            terminations=_at_the_end(demonstration, demonstration.terminated),
            truncations=_at_the_end(demonstration, not demonstration.terminated),
            infos={"success": np.array([False] * demonstration.steps + [demonstration.success])},
        )
        on_episode()


def _at_the_end(demonstration: Demonstration, value: bool) -> list[bool]:
    return [False] * (demonstration.steps - 1) + [value]


def _description(demonstrations: Demonstrations) -> str:
    return (
        f"{len(demonstrations)} episodes of {demonstrations.env} (edition {demonstrations.edition}, disturbances "
        f"{demonstrations.disturbances or 'unknown'}) by {demonstrations.agent}. Observations in the robot frame, as the agent "
        f"saw them; actions are {demonstrations.meaning}, interpolation order {demonstrations.order}."
    )
