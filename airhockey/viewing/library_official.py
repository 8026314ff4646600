"""Episodes of the official package's `dataset.pkl`.

A pickle can run code, so it is read with an unpickler that knows nothing but NumPy's arrays and Python's plain containers.
"""

import io
import pickle
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.editions import DEFAULT, edition_of_names
from airhockey.envs.specs import IIWA
from airhockey.errors import ConfigurationError
from airhockey.inputs.broken import check_size
from airhockey.viewing.entries import Entry, Library
from airhockey.viewing.episodes import Outcome, episode_recording
from airhockey.viewing.games import game_recording
from airhockey.viewing.recording import Recording

Array = NDArray[np.float64]
DATASET = "dataset.pkl"
ADMITTED = frozenset(
    {
        ("builtins", name)
        for name in ("list", "tuple", "dict", "set", "bool", "int", "float", "str", "bytes", "bytearray")
    }
    | {(f"numpy.{core}.multiarray", name) for core in ("core", "_core") for name in ("_reconstruct", "scalar")}
    | {(f"numpy.{core}.numeric", "_frombuffer") for core in ("core", "_core")}
    | {("numpy", "ndarray"), ("numpy", "dtype"), ("_codecs", "encode")}
)
"""What an official dataset is made of."""
GAME = "tournament"
ENVIRONMENT_OF_WIDTH = {12: "3dof-hit", 20: "7dof-defend", 23: "7dof-hit", 46: GAME}
"""An environment whose observations are this long, for datasets outside a folder named after theirs; the scene is the same."""
_FIELDS, _LONGEST = 6, 1024
LARGEST_DATASET = 4 << 30
"""In bytes; a thousand episodes of the tournament's length have a tenth of it."""


class DatasetUnpickler(pickle.Unpickler):
    """Reads arrays and plain containers, and refuses everything else."""

    def find_class(self, module: str, name: str) -> Any:
        """Find what the pickle names, if it is admitted."""
        if (module, name) not in ADMITTED:
            raise pickle.UnpicklingError(f"it asks for {module}.{name}, which no dataset needs")
        found = super().find_class(module, name)
        return _only_of(found) if found in (bytes, bytearray) else found


def read_dataset(path: Path) -> list[tuple[Any, ...]]:
    """The transitions of a dataset: (state, action, reward, next state, absorbing, last).

    Raises:
        ConfigurationError: It is no dataset, it is cut short, or it asks for more than arrays.
    """
    try:
        check_size(path, LARGEST_DATASET)
        content: Any = DatasetUnpickler(io.BytesIO(path.read_bytes())).load()
    except ConfigurationError:
        raise
    except OSError as error:
        raise ConfigurationError(f"cannot read {str(path)!r}: {error.strerror}") from error
    except Exception as error:  # a pickle that is not one fails in any way it likes
        raise ConfigurationError(f"{str(path)!r} is not a dataset: {' '.join(str(error).split())}") from error
    rows: list[tuple[Any, ...]] = content if isinstance(content, list) else []
    if not rows or not all(map(_is_transition, rows)):
        raise ConfigurationError(f"{str(path)!r} is not a dataset: not a list of transitions of {_FIELDS} parts")
    return rows


def _is_transition(row: Any) -> bool:
    """States must be small arrays: lists in lists in lists would be walked through for ever."""
    if not isinstance(row, tuple) or len(row) != _FIELDS:
        return False
    return all(isinstance(row[k], np.ndarray) and row[k].ndim == 1 and row[k].size <= _LONGEST for k in (0, 3))


def _only_of(kind: Callable[..., Any]) -> Callable[..., Any]:
    """`bytes` and `bytearray` of what is there: a number would ask for so much memory."""

    def made(content: Any = b"", *how: str) -> Any:
        if not isinstance(content, (bytes, bytearray, str)):
            raise pickle.UnpicklingError(f"it asks for {kind.__name__} of {type(content).__name__}")
        return kind(content, *how)

    return made


def episodes_of(transitions: Sequence[tuple[Any, ...]]) -> list[Array]:
    """The observations of each episode, one more than it has steps. Each of shape (T + 1, d)."""
    episodes, rows = [], []
    for state, _, _, following, _, last in transitions:
        rows.append(state)
        if last:
            episodes.append(np.asarray([*rows, following], dtype=np.float64))
            rows = []
    if rows:
        episodes.append(np.asarray([*rows, following], dtype=np.float64))
    return episodes


def add_datasets(library: Library, paths: Sequence[Path]) -> None:
    """Add the episodes of official datasets; those that cannot be read are noted, unless there is only one."""
    for path in paths:
        try:
            _add(library, path, several=len(paths) > 1)
        except ConfigurationError as error:
            if len(paths) == 1:
                raise
            library.notes.append(str(error))


def open_dataset(path: Path) -> tuple[str, str, list[Array]]:
    """Environment, edition and observations of a dataset's episodes; these each of shape (T + 1, d).

    The environment is that which the file's folder is named after, or one whose observations are as long.

    Raises:
        ConfigurationError: It is no dataset, or of no environment that there is.
    """
    try:
        episodes = episodes_of(read_dataset(path))
        widths = sorted({seen.shape[1] for seen in episodes})
    except (ValueError, IndexError) as error:
        raise ConfigurationError(f"{str(path)!r} is not a dataset: {error}") from error
    folder = path.parent.name
    year = edition_of_names((folder,))
    env = folder if year is not None or folder == GAME else ENVIRONMENT_OF_WIDTH.get(widths[0])
    if env is None or len(widths) > 1:
        known = ", ".join(str(width) for width in ENVIRONMENT_OF_WIDTH)
        there = " and of ".join(map(str, widths))
        raise ConfigurationError(f"{str(path)!r} has observations of {there} numbers; environments have {known}")
    return env, year or DEFAULT, episodes


def _add(library: Library, path: Path, several: bool) -> None:
    env, year, episodes = open_dataset(path)
    if env != path.parent.name:
        library.notes.append(f"which environment {path.name} is of is not known; its observations look like {env}'s")
    for index, seen in enumerate(episodes):
        name = f"{env}/{index}" if several else str(index)
        library.entries.append(Entry(name, _loader(name, env, seen, year)))


def _loader(name: str, env: str, seen: Array, year: str) -> Callable[[], Recording]:
    def load() -> Recording:
        if env == GAME:
            return game_recording(name, in_world(seen), None)
        return episode_recording(name, env, "recorded agent", {"observations": seen}, Outcome(), year=year)

    return load


def in_world(seen: Array) -> Array:
    """Both players' observations as base observations, as films hold them. Shapes (T, 46)."""
    base, n = np.array(IIWA.base_positions[0]), IIWA.n_joints
    rows = seen.reshape(len(seen), 2, -1).copy()
    rows[:, 1, 0:6] = rows[:, 0, 0:6]
    for k, side in enumerate((1.0, -1.0)):
        tip = slice(6 + 2 * n, 9 + 2 * n)
        rows[:, k, tip] = (rows[:, k, tip] + base) * [side, side, 1.0]
    rows[:, :, :3] += [base[0], base[1], 0.0]
    return rows.reshape(len(seen), -1)
