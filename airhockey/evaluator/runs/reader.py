"""Folders of results, opened for reading whatever state they are in: what is there is read, what is missing is said.

A folder may belong to a run that is still being played, that was killed, that lost a file, or to somebody else altogether.
"""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic, TypeVar

import h5py
import msgspec

from airhockey.errors import ConfigurationError
from airhockey.evaluator.match import MatchOptions
from airhockey.evaluator.runs import trajectories
from airhockey.evaluator.runs.game_records import GameRecord, file_name
from airhockey.evaluator.runs.journal import read_journal
from airhockey.evaluator.runs.manifest import MATCH, RUN, TOURNAMENT, Manifest, read_manifest
from airhockey.evaluator.runs.records import EpisodeRecord, Job, Options
from airhockey.evaluator.runs.trajectories import TRAJECTORIES
from airhockey.evaluator.schedule import TournamentOptions

MANIFESTS = (RUN, MATCH, TOURNAMENT)
AnyOptions = TypeVar("AnyOptions")
BROKEN = (
    OSError,
    LookupError,
    ValueError,
    TypeError,
    AttributeError,
    RuntimeError,
    MemoryError,
    msgspec.MsgspecError,
)
"""What reading a file raises whose bytes are not what they were, or that is somebody else's."""


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


@dataclass
class Run(_Folder[Options]):
    """Episodes of tasks.

    Attributes:
        records: Of the finished episodes.
        files: Trajectory files that can be read.
    """

    records: list[EpisodeRecord] = field(default_factory=list)
    files: list[Path] = field(default_factory=list)

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
    """Games of a match or of a tournament.

    Attributes:
        records: Of the finished games.
    """

    records: list[GameRecord] = field(default_factory=list)

    def film(self, record: GameRecord) -> Path | None:
        """The film of a game, None where there is none."""
        film = self.path / "films" / f"{file_name(record.job.key)}.h5"
        return film if film.is_file() else None


class Match(Games[MatchOptions]):
    """Games of one pair of players."""


class Tournament(Games[TournamentOptions]):
    """Games of everybody against everybody."""


class Unreadable(_Folder[Options]):
    """A path at which there is nothing to report on; the notes say why."""


Source = Run | Match | Tournament | Unreadable


def open_source(path: Path) -> Source:
    """What lies at a path."""
    if (path / RUN).exists() or any((path / name).exists() for name in (TRAJECTORIES, "trajectories")):
        return _usable(_open_run(path), path)
    if (path / MATCH).exists():
        return _usable(_open_games(Match(path), MATCH, MatchOptions), path)
    if (path / TOURNAMENT).exists():
        return _usable(_open_games(Tournament(path), TOURNAMENT, TournamentOptions), path)
    if not path.exists():
        return Unreadable(path, notes=["there is no such folder"])
    if not path.is_dir():
        return Unreadable(path, notes=["it is not a folder; give the folder of a run, a match or a tournament"])
    return Unreadable(path, notes=[f"it holds no results: there is none of {', '.join(MANIFESTS)} in it"])


def short_name(agent: str) -> str:
    """An agent's name without the path of its folder, which is nobody else's business."""
    if "://" in agent or "/" not in agent:
        return agent
    parts = [part for part in Path(agent).parts if part != "air_hockey_agent"]
    return parts[-1].removesuffix(".zip")


def _usable(source: Run | Match | Tournament, path: Path) -> Source:
    if source.records:
        return source
    what = "no episode is finished" if isinstance(source, Run) else "no game is finished"
    return Unreadable(path, notes=[*source.notes, what])


def _open_run(path: Path) -> Run:
    run = Run(path)
    try:
        run.manifest = read_manifest(path, RUN, Options)
    except (ConfigurationError, OSError) as error:
        run.notes.append(f"{_why(error, path / RUN)}; agent, seed and versions are unknown")
    by_job: dict[Job, EpisodeRecord] = {}
    for file in _trajectory_files(run):
        try:
            by_job.update((record.job, record) for record in trajectories.read_records(file))
            run.files.append(file)
        except BROKEN as error:
            run.notes.append(f"cannot read {file.relative_to(path)}: {reason(error, path)}")
    stored = len(by_job)
    for record in _journal(run):
        by_job.setdefault(record.job, record)
    run.records = sorted(by_job.values(), key=lambda record: (record.env, record.index))
    if len(by_job) > stored:
        run.notes.append(
            f"the trajectories of {len(by_job) - stored} episodes are missing: only their records are left"
        )
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


def _journal(run: Run) -> list[EpisodeRecord]:
    try:
        records, unreadable = read_journal(run.path, EpisodeRecord)
    except OSError as error:
        run.notes.append(f"cannot read journal.jsonl: {reason(error, run.path)}")
        return []
    if not (run.path / "journal.jsonl").exists():
        run.notes.append("journal.jsonl is missing")
    if unreadable:
        run.notes.append(f"{_count(unreadable, 'line')} of journal.jsonl cannot be read")
    return records


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


def _open_games(games: Match | Tournament, name: str, kind: type[Any]) -> Match | Tournament:
    try:
        games.manifest = read_manifest(games.path, name, kind)
    except (ConfigurationError, OSError) as error:
        games.notes.append(f"{_why(error, games.path / name)}; options and versions are unknown")
    try:
        games.records, unreadable = read_journal(games.path, GameRecord)
    except OSError as error:
        games.notes.append(f"cannot read journal.jsonl: {reason(error, games.path)}")
        return games
    if not (games.path / "journal.jsonl").exists():
        games.notes.append("journal.jsonl is missing")
    if unreadable:
        games.notes.append(f"{_count(unreadable, 'line')} of journal.jsonl cannot be read")
    missing = [record.job.key for record in games.records if games.film(record) is None and record.steps]
    if missing:
        games.notes.append(
            f"{_count(len(missing), 'film')} missing, of game {', '.join(missing[:5])}{'…' * (len(missing) > 5)}"
        )
    return games


def _why(error: BaseException, manifest: Path) -> str:
    """Why a manifest cannot be read, without the path of its folder, which stands beside the note."""
    return reason(error, manifest.parent) if manifest.exists() else f"{manifest.name} is missing"


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'s' if number != 1 else ''}"


def reason(error: BaseException, folder: Path) -> str:
    """What went wrong in a folder, in a line, without the folder's path, which stands beside it."""
    said = getattr(error, "strerror", None) or str(error) or type(error).__name__
    return " ".join(said.replace(f"{folder}/", "").split())[:200]
