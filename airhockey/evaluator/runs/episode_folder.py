"""The folder of a run of episodes:

    run.json            the manifest
    journal.jsonl       a line per finished episode
    trajectories/       HDF5 segments while the run lasts, each complete from the moment it has its name
    trajectories.h5     the segments as one file, once the run is finished
    result.json         what `--json` prints, once the run is finished

An episode is finished when a named segment holds it, with its record; the journal follows, and is mended from the
segments when a run is resumed. So a kill costs the last second's episodes and nothing else.
"""

import shutil
import time
from pathlib import Path
from typing import Any

from airhockey.evaluator.checks import check_options
from airhockey.evaluator.runs import journal, trajectories
from airhockey.evaluator.runs.disk import disk_errors
from airhockey.evaluator.runs.folder import RunFolder
from airhockey.evaluator.runs.keeping import Recipe
from airhockey.evaluator.runs.manifest import RUN
from airhockey.evaluator.runs.records import Episode, EpisodeRecord, Options
from airhockey.inputs.broken import BROKEN, reading_errors

SEGMENTS = "trajectories"
SEGMENT_SECONDS = 1.0  # how much work a kill may cost
SEGMENT_EPISODES = 64  # how many trajectories wait in memory


class EpisodeFolder(RunFolder[Options, EpisodeRecord]):
    """The folder of a run of episodes, opened for writing."""

    name, options_type, record_type = RUN, Options, EpisodeRecord

    def __init__(self, *arguments: Any) -> None:
        self._waiting: list[Episode] = []
        self._flushed_at = 0.0
        self._next_segment = 0
        super().__init__(*arguments)

    @classmethod
    def check(cls, options: Options) -> None:
        """See `check_options`."""
        check_options(options)

    @property
    def trajectories(self) -> Path:
        """The file that there is once the run is finished."""
        return self.path / trajectories.TRAJECTORIES

    def close(self) -> None:
        """Finish the episodes added so far, and let others have it."""
        try:
            self.flush()
        finally:
            super().close()

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
        with disk_errors(self.path):
            (self.path / SEGMENTS).mkdir(exist_ok=True)
            segment = self.path / SEGMENTS / f"{self._next_segment:06d}.h5"
            trajectories.write(segment, episodes, self.manifest.options.trajectories, self._recipe)
        self._next_segment += 1
        self.keep(*(episode.record for episode in episodes))
        self._flushed_at = time.monotonic()

    def merge(self) -> None:
        """Make one trajectory file of the segments, where that is not done."""
        self.flush()
        with disk_errors(self.path):
            if not self.trajectories.exists():
                trajectories.merge(self._named_segments(), self.trajectories)
            shutil.rmtree(self.path / SEGMENTS, ignore_errors=True)

    def recover(self) -> list[EpisodeRecord]:
        """The records of what is finished; the journal is made to say the same."""
        if self.trajectories.exists():
            with reading_errors(self.trajectories):
                records = trajectories.read_records(self.trajectories)
        else:
            records = [record for segment in self._named_segments() for record in self._recover_segment(segment)]
        if records or (self.path / journal.NAME).exists():
            journal.mend(self.path, records)
        return records

    @property
    def _recipe(self) -> Recipe:
        """What episodes are computed again from."""
        manifest = self.manifest
        options = manifest.options
        return Recipe(seed=options.seed, edition=options.edition, profile=manifest.profile, versions=manifest.versions)

    def _recover_segment(self, segment: Path) -> list[EpisodeRecord]:
        """A segment's records; one that a power failure broke is put aside, and its episodes are played again."""
        self._next_segment = int(segment.stem) + 1
        try:
            return trajectories.read_records(segment)
        except BROKEN:
            segment.rename(segment.with_suffix(".broken"))
            return []

    def _named_segments(self) -> list[Path]:
        return sorted((self.path / SEGMENTS).glob("*.h5"))
