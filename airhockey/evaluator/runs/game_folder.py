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
from airhockey.evaluator.runs.game_trajectories import write_film


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

    def add(self, game: Game) -> None:
        """Keep a game; it is on the disk when this returns."""
        if game.film.size:
            with disk_errors(self.path):
                films = self.path / "films"
                films.mkdir(exist_ok=True)
                film = films / f"{file_name(game.record.key)}.h5"
                write_film(film, game.film, JSON.encode(game.record) + b"\n")
        self.keep(game.record)
