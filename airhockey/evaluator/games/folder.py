"""A folder of games: a manifest, a journal with a line per finished game, and a film of each.

    match.json or tournament.json     the manifest
    journal.jsonl                     a line per finished game, written to the disk before the next one is taken
    films/KEY.h5                      where puck and joints were
    result.json                       once everything is played

A game is finished when its line stands in the journal; its film is written before. A kill costs the games under way.
"""

import fcntl
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Generic, Self, TypeVar

import msgspec

from airhockey.errors import ConfigurationError
from airhockey.evaluator.games.film import write_film
from airhockey.evaluator.games.player import Game
from airhockey.evaluator.games.records import GameRecord
from airhockey.evaluator.store import disk_errors, replace_file

Manifest = TypeVar("Manifest", bound=msgspec.Struct)
_JSON = msgspec.json.Encoder()


class GameFolder(Generic[Manifest]):
    """A folder of games, opened for writing by one process at a time.

    Attributes:
        path: The folder.
        manifest: What is played.
        records: Of the finished games, in the order in which they finished.
    """

    def __init__(self, path: Path, name: str, manifest: Manifest) -> None:
        """Use `create` or `open`."""
        self.path, self.manifest, self._name = path, manifest, name
        self._lock = (path / name).open()
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self._lock.close()
            raise ConfigurationError(f"another process is at work on the games in {str(path)!r}") from None
        self.records = read_games(path)
        with disk_errors(path):  # a line that a kill cut short goes away
            replace_file(path / "journal.jsonl", _JSON.encode_lines(self.records))

    @classmethod
    def create(cls, path: Path, name: str, manifest: Manifest) -> Self:
        """Begin in a folder that does not exist or is empty.

        Raises:
            ConfigurationError: The folder holds something, or cannot be written.
        """
        try:
            if path.is_dir() and any(path.iterdir()):
                raise ConfigurationError(
                    f"{str(path)!r} is not empty: choose another --out, or continue what is in it with --resume"
                )
            path.mkdir(parents=True, exist_ok=True)
            write_manifest(path / name, manifest)
        except OSError as error:
            raise ConfigurationError(f"cannot write games to {str(path)!r}: {error.strerror}") from error
        return cls(path, name, manifest)

    @classmethod
    def open(cls, path: Path, name: str, kind: type[Manifest]) -> Self:
        """Take up what was begun before; raises `ConfigurationError` if there is nothing."""
        return cls(path, name, read_game_manifest(path, name, kind))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._lock.close()

    @property
    def done(self) -> set[str]:
        """Keys of the games that need not be played again."""
        return {record.job.key for record in self.records}

    def change(self, manifest: Manifest) -> None:
        """Replace the manifest, for a tournament that gets another entry."""
        with disk_errors(self.path):
            write_manifest(self.path / self._name, manifest)
        self.manifest = manifest

    def add(self, game: Game) -> None:
        """Keep a game; it is on the disk when this returns."""
        line = _JSON.encode(game.record) + b"\n"
        with disk_errors(self.path):
            if game.film.size:
                films = self.path / "films"
                films.mkdir(exist_ok=True)
                write_film(films / f"{game.record.job.key.replace('/', '_')}.h5", game.film, line)
            with (self.path / "journal.jsonl").open("ab") as journal:
                journal.write(line)
                journal.flush()
                os.fsync(journal.fileno())
        self.records.append(game.record)

    def keep_result(self, result: msgspec.Struct) -> None:
        """Leave the result beside the games."""
        with disk_errors(self.path):
            write_manifest(self.path / "result.json", result)


def write_manifest(path: Path, content: msgspec.Struct) -> None:
    """Write a record as indented JSON, whole or not at all."""
    replace_file(path, msgspec.json.format(_JSON.encode(content), indent=2) + b"\n")


def read_game_manifest(path: Path, name: str, kind: type[Manifest]) -> Manifest:
    """The manifest in a folder of games.

    Raises:
        ConfigurationError: There is none, or it cannot be read.
    """
    try:
        return msgspec.json.decode((path / name).read_bytes(), type=kind)
    except OSError:
        raise ConfigurationError(f"there is nothing to continue in {str(path)!r}: it has no {name}") from None
    except (msgspec.MsgspecError, ValueError) as error:
        raise ConfigurationError(f"cannot read {str(path / name)!r}: {error}") from error


def read_games(path: Path) -> list[GameRecord]:
    """The records in a folder's journal; a torn last line is left out."""
    journal = path / "journal.jsonl"
    records: dict[str, GameRecord] = {}
    for line in journal.read_bytes().splitlines() if journal.exists() else []:
        try:
            record = msgspec.json.decode(line, type=GameRecord)
        except msgspec.MsgspecError:
            continue
        records[record.job.key] = record
    return list(records.values())


def in_order(records: Sequence[GameRecord], keys: Sequence[str]) -> list[GameRecord]:
    """The records of these games, in this order; those not played yet are left out."""
    by_key = {record.job.key: record for record in records}
    return [by_key[key] for key in keys if key in by_key]
