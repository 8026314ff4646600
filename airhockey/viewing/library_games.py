"""Games of matches and tournaments, with their records where there are any."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from airhockey.viewing.library import Entry, Library

if TYPE_CHECKING:
    from airhockey.evaluator.runs.game_records import GameRecord
    from airhockey.viewing.recording import Recording


def add_games(library: Library) -> None:
    """Add the games of a folder, if it is one of games."""
    from airhockey.evaluator.runs.game_records import GameRecord, file_name
    from airhockey.evaluator.runs.journal import read_journal
    from airhockey.evaluator.runs.manifest import MATCH, TOURNAMENT

    path = library.path
    films = {film.stem: film for film in sorted((path / "films").glob("*.h5"), key=_natural)}
    if not films and not any((path / name).exists() for name in (MATCH, TOURNAMENT)):
        return
    records = {record.job.key: record for record in read_journal(path, GameRecord).records}
    for key, record in records.items():
        film = films.pop(file_name(key), None)
        if film is not None:
            library.entries.append(Entry(key, _loader(key, film, record)))
        elif record.steps:
            library.notes.append(f"game {key} has no film")
        else:
            library.notes.append(f"game {key} was forfeited before its first step")
    for stem, film in films.items():
        library.notes.append(f"film {film.name} is of a game that the journal does not name")
        library.entries.append(Entry(stem, _loader(stem, film, None)))
    library.notes += _unplayed(path, len(records))


def _loader(name: str, film: Path, record: "GameRecord | None") -> "Callable[[], Recording]":
    def load() -> "Recording":
        import numpy as np

        from airhockey.errors import ConfigurationError
        from airhockey.evaluator.runs.game_trajectories import read_film
        from airhockey.viewing.games import game_recording

        try:
            rows = read_film(film)
        except (OSError, KeyError) as error:
            raise ConfigurationError(f"cannot read {str(film)!r}: {' '.join(str(error).split())}") from error
        return game_recording(name, np.asarray(rows, dtype=np.float64), record or _record_in(film))

    return load


def _record_in(film: Path) -> "GameRecord | None":
    """The record that was written into the film itself."""
    import h5py
    import msgspec

    from airhockey.evaluator.runs.game_records import GameRecord

    try:
        with h5py.File(film) as file:
            return msgspec.json.decode(bytes(file.attrs["record"].tobytes()), type=GameRecord)
    except (OSError, KeyError, AttributeError, msgspec.MsgspecError):
        return None


def _unplayed(path: Path, played: int) -> list[str]:
    """What a manifest promises and the journal does not hold."""
    import msgspec

    for name in ("match.json", "tournament.json"):
        try:
            manifest: Any = msgspec.json.decode((path / name).read_bytes())
        except (OSError, msgspec.MsgspecError, ValueError):
            continue
        asked = manifest.get("options", {}).get("games") if isinstance(manifest, dict) else None
        if isinstance(asked, int) and played < asked:
            return [f"the match is not finished: {played} of its {asked} games are there"]
        return []
    return ["there is neither match.json nor tournament.json: what was played is not known"]


def _natural(path: Path) -> list[Any]:
    """ "10" after "9"."""
    import re

    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", path.stem)]
