"""A tournament: every entry plays every other one at home and away, in one phase or two."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import msgspec

from airhockey.errors import ConfigurationError
from airhockey.evaluator.engines.engine import Engine
from airhockey.evaluator.entries import Entry
from airhockey.evaluator.judging.standings import Standings, standings, write_standings
from airhockey.evaluator.match import play_games
from airhockey.evaluator.runs.game_folder import GameFolder
from airhockey.evaluator.runs.game_records import GameRecord
from airhockey.evaluator.runs.journal import read_journal
from airhockey.evaluator.runs.manifest import TOURNAMENT, Manifest
from airhockey.evaluator.schedule import TournamentOptions, check_tournament, extended, schedule

OnStandings = Callable[[GameRecord, Standings], None]


class TournamentFolder(GameFolder[TournamentOptions]):
    """The folder of a tournament, opened for writing."""

    name, options_type = TOURNAMENT, TournamentOptions

    @classmethod
    def check(cls, options: TournamentOptions) -> None:
        """See `check_tournament`."""
        check_tournament(options)


begin_tournament = TournamentFolder.begin


def resume_tournament(
    path: Path,
    added: Iterable[Entry] = (),
    asked: Mapping[str, Any] | None = None,
    phases: int | None = None,
    replacements: Mapping[str, str] | None = None,
) -> TournamentFolder:
    """Take up a tournament that was interrupted, or extend it: only the missing games will be played.

    Args:
        path: Its folder.
        added: More entries; those that it has already change nothing.
        asked: Options that the user repeated; they must be the tournament's.
        phases: 2 adds a second phase to a tournament of one.
        replacements: Name -> agent that plays for it in phase 2, as long as none of its games there is played.

    Raises:
        ConfigurationError: There is none, an option is not valid, or the software has changed.
    """
    folder = TournamentFolder.resume(path, asked)
    with folder.released_on_error():
        options = extended(folder.manifest.options, tuple(added), phases, replacements or {})
        if options != folder.manifest.options:
            check_tournament(options)
            folder.check_work(job.key for job in schedule(options))
            _check_played(folder.records, options)
            folder.change(options)
    return folder


def play_tournament(
    folder: TournamentFolder, engine: Engine | None = None, on_standings: OnStandings | None = None
) -> Standings:
    """Play the missing games; the standings are on the disk after every one.

    Args:
        folder: From `begin_tournament` or `resume_tournament`; it is closed afterwards.
        engine: Where the games are played; here, one after the other, if not given.
        on_standings: Called with every record as it comes, and the standings after it.
    """
    options = folder.manifest.options
    jobs = schedule(options)
    names = [entry.name for entry in options.entries]

    def table_so_far() -> Standings:
        table = standings(names, jobs, folder.records, options.game.edition)
        return write_standings(folder.path, msgspec.structs.replace(table, inputs=folder.manifest.inputs))

    def on_game(record: GameRecord) -> None:
        table = table_so_far()
        if on_standings is not None:
            on_standings(record, table)

    with folder:
        play_games(folder, jobs, engine, on_game)
        return table_so_far()


def read_standings(path: Path) -> tuple[Manifest[TournamentOptions], Standings]:
    """The standings of a tournament from its folder, finished or not, without playing."""
    manifest = TournamentFolder.read(path)
    options = manifest.options
    names, records = [entry.name for entry in options.entries], read_journal(path, GameRecord).records
    found = standings(names, schedule(options), records, options.game.edition)
    return manifest, msgspec.structs.replace(found, inputs=manifest.inputs)


def _check_played(records: Iterable[GameRecord], options: TournamentOptions) -> None:
    """A game that was played stays what it was; raises `ConfigurationError`."""
    jobs = {job.key: job for job in schedule(options)}
    for record in records:
        job = jobs[record.job.key]
        if (job.home_agent, job.away_agent) != (record.job.home_agent, record.job.away_agent):
            name = job.home if job.home_agent != record.job.home_agent else job.away
            raise ConfigurationError(f"{name!r} has played games of phase 2 already: it cannot be replaced any more")
