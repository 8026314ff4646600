"""A folder of games: a manifest, a journal with a line per finished game, and a film of each.

    match.json or tournament.json     the manifest
    journal.jsonl                     a line per finished game, written to the disk before the next one is taken
    films/KEY.h5                      where puck and joints were
    live/KEY                          a game in progress
    result.json                       of a match, once everything is played
    standings.json, standings.csv     of a tournament, after every game

A game is finished when its line stands in the journal; its film is written before. A kill costs the games under way.
"""

import os
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Generic, Self, TypeVar

import msgspec

from airhockey.envs.disturbances import Disturbances, load_disturbances
from airhockey.errors import ConfigurationError
from airhockey.evaluator.play.game import Game
from airhockey.evaluator.runs.disk import JSON, begin_folder, disk_errors, lock_folder, replace_file, write_record
from airhockey.evaluator.runs.game_records import GameRecord, file_name
from airhockey.evaluator.runs.game_trajectories import write_film

Manifest = TypeVar("Manifest", bound=msgspec.Struct)


class GameFolder(Generic[Manifest]):
    """A folder of games, opened for writing by one process at a time.

    Attributes:
        path: The folder.
        manifest: What is played.
        records: Of the finished games, in the order in which they finished.
    """

    def __init__(self, path: Path, name: str, kind: type[Manifest]) -> None:
        """Use `create` or `open`."""
        self.path, self._name = path, name
        self._lock = lock_folder(path)
        try:
            self.manifest = read_game_manifest(path, name, kind)
            self.records = read_games(path)
            with disk_errors(path):
                self._tidy()
        except BaseException:
            os.close(self._lock)
            raise

    @classmethod
    def create(cls, path: Path, name: str, manifest: Manifest) -> Self:
        """Begin in a folder that does not exist or is empty.

        Raises:
            ConfigurationError: The folder holds something, or cannot be written.
        """
        begin_folder(path, name, manifest)
        return cls(path, name, type(manifest))

    @classmethod
    def open(cls, path: Path, name: str, kind: type[Manifest]) -> Self:
        """Take up what was begun before.

        Raises:
            ConfigurationError: There is nothing, or another process is at work on it.
        """
        read_game_manifest(path, name, kind)
        return cls(path, name, kind)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let others have it."""
        shutil.rmtree(self.live, ignore_errors=True)
        os.close(self._lock)

    @property
    def live(self) -> Path:
        """Where games in progress are shown."""
        return self.path / "live"

    @property
    def done(self) -> set[str]:
        """Keys of the games that need not be played again."""
        return {record.job.key for record in self.records}

    def change(self, manifest: Manifest) -> None:
        """Replace the manifest, for a tournament that gets another entry."""
        with disk_errors(self.path):
            write_record(self.path / self._name, manifest)
        self.manifest = manifest

    def add(self, game: Game) -> None:
        """Keep a game; it is on the disk when this returns."""
        line = JSON.encode(game.record) + b"\n"
        with disk_errors(self.path):
            if game.film.size:
                films = self.path / "films"
                films.mkdir(exist_ok=True)
                write_film(films / f"{file_name(game.record.job.key)}.h5", game.film, line)
            with (self.path / "journal.jsonl").open("ab") as journal:
                journal.write(line)
                journal.flush()
                os.fsync(journal.fileno())
        self.records.append(game.record)

    def _tidy(self) -> None:
        """What a kill left half done goes away: a line that was cut short, games that were being played."""
        whole = JSON.encode_lines(self.records)
        journal = self.path / "journal.jsonl"
        if not journal.exists() or journal.read_bytes() != whole:
            replace_file(journal, whole)
        shutil.rmtree(self.live, ignore_errors=True)
        self.live.mkdir()

    def keep_result(self, result: msgspec.Struct) -> None:
        """Leave the result beside the games."""
        with disk_errors(self.path):
            write_record(self.path / "result.json", result)


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
        except (msgspec.MsgspecError, UnicodeDecodeError):
            continue
        records[record.job.key] = record
    return list(records.values())


def check_repeated(path: Path, asked: Mapping[str, Any], began: msgspec.Struct, profile: Disturbances) -> None:
    """Options that are given again for what goes on must be those that it began with.

    Args:
        path: Of the folder, for the message.
        asked: Options that the user repeated, by name.
        began: The options that it began with; those of a game are in its field `game`.
        profile: The disturbances that it began with; a file of them may have changed since.

    Raises:
        ConfigurationError: One of them is another.
    """
    for name, value in asked.items():
        began_with = getattr(began, name) if hasattr(began, name) else getattr(began.game, name)  # type: ignore[attr-defined]
        same = load_disturbances(value) == profile if name == "disturbances" else value == began_with
        if not same:
            raise ConfigurationError(f"what is in {str(path)!r} has {name} {began_with!r}, not {value!r}")


def in_order(records: Sequence[GameRecord], keys: Sequence[str]) -> list[GameRecord]:
    """The records of these games, in this order; those not played yet are left out."""
    by_key = {record.job.key: record for record in records}
    return [by_key[key] for key in keys if key in by_key]
