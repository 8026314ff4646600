"""A game as it was played, for replays: where puck and joints truly were at every step, in single precision."""

from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from airhockey.evaluator.runs.disk import new_hdf5, opened_hdf5
from airhockey.evaluator.runs.game_records import GameRecord

Rows = NDArray[np.float32]


class Film:
    """Keeps one row per control step: the base observation at the step's end, in world coordinates.

    Args:
        steps: Most rows; all the memory is taken at once.
        width: Entries of a base observation.
    """

    def __init__(self, steps: int, width: int) -> None:
        self._rows = np.full((steps, width), np.nan, dtype=np.float32)
        self._filled = 0

    @property
    def rows(self) -> Rows:
        """What was kept. Shape (steps played, width)."""
        return self._rows[: self._filled]

    def add(self, env: Any) -> None:
        """Keep the present state."""
        self._rows[self._filled] = env.base_observation
        self._filled += 1


def write_film(path: Path, rows: Rows, record: bytes) -> None:
    """Write a game's rows, with its record as JSON; the file is complete once it has its name."""
    with new_hdf5(path) as file:
        file.create_dataset(
            "base_observations", data=rows, chunks=True, compression="gzip", compression_opts=1, shuffle=True
        )
        file.attrs["record"] = np.void(record)


def read_film(path: Path, steps: slice = slice(None)) -> Rows:
    """The base observations of a game, or of some of its steps. Shape (steps, 46)."""
    with opened_hdf5(path) as file:
        return np.asarray(file["base_observations"][steps])


def read_film_record(path: Path) -> GameRecord:
    """The game's record, as it was written into its film."""
    with opened_hdf5(path) as file:
        return msgspec.json.decode(file.attrs["record"].tobytes(), type=GameRecord)
