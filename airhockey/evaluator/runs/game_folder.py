"""The folder of a match or a tournament:

    match.json or tournament.json     the manifest
    journal.jsonl                     a line per finished game
    films/KEY.h5                      where puck and joints were
    live/KEY                          a game in progress
    result.json                       of a match, once everything is played
    standings.json, standings.csv     of a tournament, after every game

A game is finished when its line stands in the journal; its film is written before. A kill costs the games under way.
"""

import shutil
from pathlib import Path

from airhockey.evaluator.play.game import Game
from airhockey.evaluator.runs.disk import JSON, disk_errors
from airhockey.evaluator.runs.folder import Options, RunFolder
from airhockey.evaluator.runs.game_records import GameRecord, file_name
from airhockey.evaluator.runs.game_trajectories import read_film_record, write_film
from airhockey.inputs.broken import BROKEN


class GameFolder(RunFolder[Options, GameRecord]):
    """The folder of a match or a tournament, opened for writing."""

    record_type = GameRecord

    @property
    def live(self) -> Path:
        """Where games in progress are shown."""
        return self.path / "live"

    def close(self) -> None:
        """Let others have it."""
        shutil.rmtree(self.live, ignore_errors=True)
        super().close()

    def recover(self) -> list[GameRecord]:
        """The finished games; those that were being played go away."""
        records = super().recover()
        shutil.rmtree(self.live, ignore_errors=True)
        self.live.mkdir()
        return records

    def believed(self, records: list[GameRecord]) -> list[GameRecord]:
        """Those that are in their films as they are in the journal; a game that failed at its start has no film."""
        edited = [record.key for record in records if not self._is_as_filmed(record)]
        if edited:
            named = ", ".join(edited[:5]) + "…" * (len(edited) > 5)
            self.notes.append(
                f"the journal in {str(self.path)!r} was edited: what it says of game {named} is not in its film; "
                "it is played again"
            )
        return [record for record in records if record.key not in edited]

    def _is_as_filmed(self, record: GameRecord) -> bool:
        try:
            return read_film_record(self._film(record)) == record
        except FileNotFoundError:
            return True
        except BROKEN:
            return False

    def _film(self, record: GameRecord) -> Path:
        return self.path / "films" / f"{file_name(record.key)}.h5"

    def add(self, game: Game) -> None:
        """Keep a game; it is on the disk when this returns."""
        if game.film.size:
            with disk_errors(self.path):
                film = self._film(game.record)
                film.parent.mkdir(exist_ok=True)
                write_film(film, game.film, JSON.encode(game.record) + b"\n")
        self.keep(game.record)
