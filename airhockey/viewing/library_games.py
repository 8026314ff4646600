"""Games of matches and tournaments, with their records where there are any."""

import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from airhockey.evaluator.runs.game_records import GameRecord
from airhockey.evaluator.runs.game_trajectories import read_film, read_film_record
from airhockey.evaluator.runs.reader import Games
from airhockey.inputs.broken import BROKEN, reading_errors
from airhockey.viewing.entries import Entry, Library
from airhockey.viewing.games import game_recording
from airhockey.viewing.recording import Recording


def add_games(library: Library, games: Games[Any]) -> None:
    """Add the games of which there are films."""
    unnamed = dict.fromkeys(games.films)
    for record in games.records:
        film = games.film(record)
        if film is not None:
            unnamed.pop(film, None)
            library.entries.append(Entry(record.key, _loader(record.key, film, record)))
        elif not record.steps:
            library.notes.append(f"game {record.key} was forfeited before its first step")
    for film in unnamed:
        library.notes.append(f"film {film.name} is of a game that the journal does not name")
        library.entries.append(Entry(film.stem, _loader(film.stem, film, None)))
    library.notes += games.notes


def _loader(name: str, film: Path, record: GameRecord | None) -> Callable[[], Recording]:
    def load() -> Recording:
        with reading_errors(film):
            rows = np.asarray(read_film(film), dtype=np.float64)
        return game_recording(name, rows, record or _record_in(film))

    return load


def _record_in(film: Path) -> GameRecord | None:
    """The record in the film itself, if that can be read."""
    with contextlib.suppress(*BROKEN):
        return read_film_record(film)
    return None
