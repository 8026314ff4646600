"""The run folder: everything that a run leaves, written so that it can be killed at any moment.

    run.json            the manifest
    journal.jsonl       a line per finished episode
    trajectories/       HDF5 segments while the run lasts, each complete from the moment it has its name
    trajectories.h5     the segments as one file, once the run is finished
    result.json         what `--json` prints, once the run is finished

An episode is finished when a named segment holds it, with its record; the journal follows, and is mended from the
segments when a run is taken up again. So a kill costs the last second's episodes and nothing else.
"""

import contextlib
import os
import shutil
import time
from pathlib import Path
from typing import Self

import msgspec

from airhockey.errors import ConfigurationError
from airhockey.evaluator.runs import trajectories
from airhockey.evaluator.runs.disk import JSON, begin_folder, disk_errors, lock_folder, replace_file, write_record
from airhockey.evaluator.runs.records import Episode, EpisodeRecord, Job, Manifest

TRAJECTORIES = "trajectories.h5"
SEGMENT_SECONDS = 1.0  # how much work a kill may cost
SEGMENT_EPISODES = 64  # how many trajectories wait in memory


class RunFolder:
    """A run's folder, opened for writing by one process at a time.

    Attributes:
        path: The folder.
        manifest: What the run is.
        records: Of the finished episodes.
        trajectories: The file that there is once the run is finished.
    """

    def __init__(self, path: Path, manifest: Manifest) -> None:
        """Use `create` or `open`."""
        self.path = path
        self.manifest = manifest
        self.trajectories = path / TRAJECTORIES
        self._segments = path / "trajectories"
        self._journal = path / "journal.jsonl"
        self._lock = lock_folder(path)
        self._waiting: list[Episode] = []
        self._flushed_at = 0.0
        self._next_segment = 0
        with disk_errors(path):
            self.records = self._recover()

    @classmethod
    def create(cls, path: Path, manifest: Manifest) -> Self:
        """Begin a run in a folder that does not exist or is empty.

        Raises:
            ConfigurationError: The folder holds something, or cannot be written.
        """
        begin_folder(path, "run.json", manifest)
        return cls(path, manifest)

    @classmethod
    def open(cls, path: Path) -> Self:
        """Take up a run that was begun before.

        Raises:
            ConfigurationError: There is none, or another process is at work on it.
        """
        return cls(path, read_manifest(path))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        try:
            self.flush()
        finally:
            os.close(self._lock)

    @property
    def done(self) -> set[Job]:
        """The episodes that need not be played again."""
        return {record.job for record in self.records}

    def add(self, episode: Episode) -> None:
        """Keep an episode; it is finished at once, or with the others of its `SEGMENT_SECONDS`.

        Raises:
            AirHockeyError: The disk is full or gone.
        """
        self._waiting.append(episode)
        if time.monotonic() - self._flushed_at > SEGMENT_SECONDS or len(self._waiting) >= SEGMENT_EPISODES:
            self.flush()

    def flush(self) -> None:
        """Finish the episodes added so far."""
        if not self._waiting:
            return
        episodes, self._waiting = self._waiting, []
        records = [episode.record for episode in episodes]
        with disk_errors(self.path):
            self._segments.mkdir(exist_ok=True)
            segment = self._segments / f"{self._next_segment:06d}.h5"
            trajectories.write(segment.with_suffix(".part"), episodes)
            segment.with_suffix(".part").rename(segment)
            self._next_segment += 1
            with self._journal.open("ab") as journal:
                journal.write(JSON.encode_lines(records))
        self.records += records
        self._flushed_at = time.monotonic()

    def merge(self) -> None:
        """Make one trajectory file of the segments, where that is not done."""
        self.flush()
        with disk_errors(self.path):
            if not self.trajectories.exists():
                trajectories.merge(self._named_segments(), self.trajectories)
            shutil.rmtree(self._segments, ignore_errors=True)

    def keep_result(self, result: msgspec.Struct) -> None:
        """Leave the result beside what it was computed from."""
        with disk_errors(self.path):
            write_record(self.path / "result.json", result)

    def _recover(self) -> list[EpisodeRecord]:
        """The records of what is finished; the journal is made to say the same."""
        if self.trajectories.exists():
            records = trajectories.read_records(self.trajectories)
        else:
            records = [record for segment in self._named_segments() for record in self._recover_segment(segment)]
        if records or self._journal.exists():
            replace_file(self._journal, JSON.encode_lines(records))
        return records

    def _recover_segment(self, segment: Path) -> list[EpisodeRecord]:
        """A segment's records; one that a power failure broke is put aside, and its episodes are played again."""
        self._next_segment = int(segment.stem) + 1
        try:
            return trajectories.read_records(segment)
        except (OSError, KeyError, msgspec.MsgspecError):
            segment.rename(segment.with_suffix(".broken"))
            return []

    def _named_segments(self) -> list[Path]:
        return sorted(self._segments.glob("*.h5"))


def read_manifest(path: Path) -> Manifest:
    """The manifest of the run in a folder.

    Raises:
        ConfigurationError: There is no run, or its manifest cannot be read.
    """
    try:
        return msgspec.json.decode((path / "run.json").read_bytes(), type=Manifest)
    except OSError:
        raise ConfigurationError(f"there is no run in {str(path)!r}: it has no run.json") from None
    except (msgspec.MsgspecError, ValueError) as error:
        raise ConfigurationError(f"cannot read {str(path / 'run.json')!r}: {error}") from error


def read_journal(path: Path) -> list[EpisodeRecord]:
    """The records of a run's journal in the order in which episodes finished; a torn last line is left out."""
    journal = path / "journal.jsonl"
    records = []
    for line in journal.read_bytes().splitlines() if journal.exists() else []:
        with contextlib.suppress(msgspec.MsgspecError, UnicodeDecodeError):
            records.append(msgspec.json.decode(line, type=EpisodeRecord))
    return records
