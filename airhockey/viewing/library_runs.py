"""Episodes of run folders: finished ones, and what there is of one that was interrupted or damaged."""

from collections.abc import Callable
from pathlib import Path

from airhockey.evaluator.analysis.failures import causes_of
from airhockey.evaluator.runs.reader import Run
from airhockey.evaluator.runs.records import EpisodeRecord
from airhockey.evaluator.runs.trajectories import read_episode
from airhockey.inputs.broken import reading_errors
from airhockey.viewing.entries import Entry, Library
from airhockey.viewing.episodes import Outcome, episode_recording
from airhockey.viewing.recording import Recording


def add_run(library: Library, run: Run) -> None:
    """Add the episodes of a run of which there are trajectories."""
    several = len({job.env for job in run.stored}) > 1
    for record in (record for env in run.environments for record in run.of(env) if record.job in run.stored):
        if record.steps:
            name = f"{record.env}/{record.index}" if several else str(record.index)
            load = _loader(name, run.stored[record.job], record, run.agent)
            library.entries.append(Entry(name, load, failed=bool(causes_of(record))))
        else:
            library.notes.append(f"episode {record.index} of {record.env} has no steps: {record.error}")
    if run.manifest is not None:
        asked = run.manifest.options.episodes * len(run.manifest.options.environments)
        if len(run.stored) < asked:
            library.notes.append(f"there are trajectories of {len(run.stored)} of its {asked} episodes")
    library.notes += run.notes


def _loader(name: str, file: Path, record: EpisodeRecord, player: str) -> Callable[[], Recording]:
    def load() -> Recording:
        with reading_errors(file):
            arrays = read_episode(file, record.env, record.index)
        title = f"{record.env}, episode {record.index}"
        return episode_recording(
            name, record.env, player, arrays, Outcome(record.success, record.error), title, record.edition
        )

    return load
