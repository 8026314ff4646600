"""Folders of results, opened for reading whatever state they are in: what is there is read, what is missing is said.

A folder may belong to a run that is still being played, that was killed, that lost a file, or to somebody else altogether.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic, TypeVar

import h5py

from airhockey.envs.editions import DEFAULT
from airhockey.errors import ConfigurationError
from airhockey.evaluator.match import MatchOptions
from airhockey.evaluator.runs import trajectories
from airhockey.evaluator.runs.game_records import GameRecord, file_name
from airhockey.evaluator.runs.journal import NAME as JOURNAL
from airhockey.evaluator.runs.journal import Record, read_journal
from airhockey.evaluator.runs.keeping import NONE
from airhockey.evaluator.runs.manifest import (
    MATCH,
    RUN,
    SWEEP,
    TOURNAMENT,
    Manifest,
    option_of,
    read_manifest,
    what_became_of,
)
from airhockey.evaluator.runs.records import EpisodeRecord, Job, Options
from airhockey.evaluator.runs.trajectories import TRAJECTORIES
from airhockey.evaluator.schedule import TournamentOptions
from airhockey.inputs.broken import BROKEN, reason

MANIFESTS = (RUN, MATCH, TOURNAMENT)
AnyOptions = TypeVar("AnyOptions")


@dataclass
class _Folder(Generic[AnyOptions]):
    """What every kind of folder has.

    Attributes:
        path: Where it is.
        manifest: What was asked for; None where that cannot be read.
        notes: What is missing, a sentence each.
    """

    path: Path
    manifest: Manifest[AnyOptions] | None = None
    notes: list[str] = field(default_factory=list)

    @property
    def versions(self) -> dict[str, str]:
        """Versions of the software."""
        return self.manifest.versions if self.manifest else {}

    @property
    def created(self) -> str:
        """When it was begun, local time; empty where nobody knows."""
        return self.manifest.created if self.manifest else ""

    @property
    def disturbances(self) -> str:
        """Name of the disturbance profile."""
        return self.manifest.profile.profile if self.manifest else "unknown"

    @property
    def edition(self) -> str:
        """The year whose rules applied."""
        return str(option_of(self.manifest.options, "edition")) if self.manifest else "unknown"

    @property
    def conditions(self) -> str:
        """What results can be compared under: the disturbance profile, and the edition unless it is the usual one."""
        usual = self.edition in (DEFAULT, "unknown")
        return self.disturbances if usual else f"{self.disturbances}, edition {self.edition}"


@dataclass
class Run(_Folder[Options]):
    """Episodes of tasks.

    Attributes:
        records: Of the finished episodes.
        stored: The file that holds an episode's trajectory, for those of which it can be read.
    """

    records: list[EpisodeRecord] = field(default_factory=list)
    stored: dict[Job, Path] = field(default_factory=dict)

    @property
    def files(self) -> list[Path]:
        """Trajectory files that can be read."""
        return list(dict.fromkeys(self.stored.values()))

    @property
    def agent(self) -> str:
        """The agent's short name."""
        return short_name(self.manifest.options.agent) if self.manifest else f"unknown ({self.path.name})"

    @property
    def environments(self) -> list[str]:
        """Names of the environments of which there are episodes, in the run's order."""
        asked = self.manifest.options.environments if self.manifest else ()
        return list(dict.fromkeys(env for env in (*asked, *(r.env for r in self.records)) if self.of(env)))

    def of(self, env: str) -> list[EpisodeRecord]:
        """The records of one environment."""
        return [record for record in self.records if record.env == env]


@dataclass
class Games(_Folder[AnyOptions]):
    """Games of a match or of a tournament, or of nobody knows which.

    Attributes:
        records: Of the finished games.
    """

    records: list[GameRecord] = field(default_factory=list)

    @property
    def films(self) -> list[Path]:
        """Every film, also of games that have no record."""
        return sorted((self.path / "films").glob("*.h5"), key=_natural)

    def film(self, record: GameRecord) -> Path | None:
        """The film of a game, None where there is none."""
        film = self.path / "films" / f"{file_name(record.job.key)}.h5"
        return film if film.is_file() else None


class Match(Games[MatchOptions]):
    """Games of one pair of players."""

    name, options_type = MATCH, MatchOptions


class Tournament(Games[TournamentOptions]):
    """Games of everybody against everybody."""

    name, options_type = TOURNAMENT, TournamentOptions


class Unreadable(_Folder[Options]):
    """A path at which there is nothing to report on; the notes say why."""


Source = Run | Match | Tournament | Unreadable


def open_source(path: Path) -> Source:
    """What lies at a path, if there is anything to report on."""
    found = look_into(path)
    if isinstance(found, (Run, Match, Tournament)) and found.records:
        return found
    if found is not None:
        what = "no episode is finished" if isinstance(found, Run) else "no game is finished"
        return Unreadable(path, notes=found.notes if found.records else [*found.notes, what])
    if not path.exists():
        return Unreadable(path, notes=["there is no such folder"])
    if (path / SWEEP).exists():
        runs = ", ".join(part.name for part in parts_of(path)) or "none is begun"
        return Unreadable(path, notes=[f"it is a sweep: name one of its runs ({runs})"])
    if not path.is_dir():
        return Unreadable(path, notes=["it is not a folder; give the folder of a run, a match or a tournament"])
    return Unreadable(path, notes=[f"it holds no results: there is none of {', '.join(MANIFESTS)} in it"])


def parts_of(path: Path) -> list[Path]:
    """The runs of a sweep, in the order of their names; the path itself where there is none."""
    if not (path / SWEEP).exists():
        return [path]
    return sorted((manifest.parent for manifest in path.glob(f"*/{RUN}")), key=_natural)


def look_into(path: Path) -> Run | Games[Any] | None:
    """What a folder holds, however little: a run that has only begun, films without a manifest; None for nothing."""
    if any((path / name).exists() for name in (RUN, TRAJECTORIES, "trajectories")):
        return _open_run(path)
    for kind in (Match, Tournament):
        if (path / kind.name).exists():
            games = kind(path)
            _read_manifest(games, kind.name, kind.options_type, "options and versions")
            return _open_games(games)
    unknown: Games[Any] = Games(
        path, notes=[f"there is neither {MATCH} nor {TOURNAMENT}: what was played is not known"]
    )
    return _open_games(unknown) if unknown.films else None


def short_name(agent: str) -> str:
    """An agent's name without the path of its folder, which is nobody else's business."""
    if "://" in agent or "/" not in agent:
        return agent
    parts = [part for part in Path(agent).parts if part != "air_hockey_agent"]
    return parts[-1].removesuffix(".zip")


def _open_run(path: Path) -> Run:
    run = Run(path)
    _read_manifest(run, RUN, Options, "agent, seed and versions")
    by_job: dict[Job, EpisodeRecord] = {}
    for file in _trajectory_files(run):
        try:
            kept = trajectories.kept_in(file)
            found = {record.job: record for record in trajectories.read_records(file)}
        except BROKEN as error:
            what = f"cannot read {file.name}" if file.name == TRAJECTORIES else f"segment {file.name} cannot be read"
            run.notes.append(f"{what}: {reason(error, path)}")
        else:
            by_job |= found
            if kept != NONE:
                run.stored |= dict.fromkeys(found, file)
    for record in _read_journal(run, EpisodeRecord):
        by_job.setdefault(record.job, record)
    run.records = sorted(by_job.values(), key=lambda record: (record.env, record.index))
    missing = len(by_job) - len(run.stored)
    if missing and run.manifest is not None and run.manifest.options.trajectories == NONE:
        run.notes.append(f"it was played with --trajectories {NONE}: there is nothing to look at, only records")
    elif missing:
        run.notes.append(f"the trajectories of {missing} episodes are missing: only their records are left")
    _check_complete(run)
    return run


def _trajectory_files(run: Run) -> list[Path]:
    """The file of a finished run, or the segments of one that is not."""
    whole = run.path / TRAJECTORIES
    segments = sorted((run.path / "trajectories").glob("*.h5"))
    broken = sorted((run.path / "trajectories").glob("*.broken"))
    run.notes += [f"{file.relative_to(run.path)} was put aside as broken" for file in broken]
    if whole.exists() and h5py.is_hdf5(whole):
        return [whole]
    return ([whole] if whole.exists() else []) + segments


def _check_complete(run: Run) -> None:
    if run.manifest is None:
        return
    if run.manifest.format != 1:
        run.notes.append(f"it has format {run.manifest.format}, written by another version; this one knows format 1")
    options = run.manifest.options
    for env in options.environments:
        played = len(run.of(env))
        if 0 < played < options.episodes or (played == 0 and run.records):
            run.notes.append(f"{env} is unfinished: {played} of {options.episodes} episodes are there")


def _open_games(games: Games[Any]) -> Games[Any]:
    games.records = _read_journal(games, GameRecord)
    missing = [record.job.key for record in games.records if games.film(record) is None and record.steps]
    if missing:
        named = ", ".join(missing[:5]) + "…" * (len(missing) > 5)
        games.notes.append(f"{_count(len(missing), 'film')} missing: game {named} has no film")
    if isinstance(games, Match) and games.manifest and len(games.records) < games.manifest.options.games:
        asked = games.manifest.options.games
        games.notes.append(f"the match is unfinished: {len(games.records)} of its {asked} games are there")
    return games


def _read_manifest(folder: _Folder[Any], name: str, kind: type[Any], unknown: str) -> None:
    """Read the manifest; where there is none, it is said what is unknown."""
    try:
        folder.manifest = read_manifest(folder.path, name, kind)
        what = what_became_of(folder.manifest)
        if what is not None:
            folder.notes.append(f"{name} {what}: the results may not be of what it says")
    except (ConfigurationError, OSError) as error:
        there = (folder.path / name).exists()
        why = reason(error, folder.path) if there else f"{name} is missing"
        folder.notes.append(f"{why}; {unknown} are unknown")


def _read_journal(folder: _Folder[Any], kind: type[Record]) -> list[Record]:
    try:
        records, unreadable = read_journal(folder.path, kind)
    except OSError as error:
        folder.notes.append(f"cannot read {JOURNAL}: {reason(error, folder.path)}")
        return []
    if not (folder.path / JOURNAL).exists():
        folder.notes.append(f"{JOURNAL} is missing")
    if unreadable:
        folder.notes.append(f"{_count(unreadable, 'line')} of {JOURNAL} cannot be read")
    return records


def _natural(path: Path) -> list[str | int]:
    """ "10" after "9"."""
    return [int(part) if part.isdigit() else part for part in re.split(r"([0-9]+)", path.stem)]


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'s' if number != 1 else ''}"
