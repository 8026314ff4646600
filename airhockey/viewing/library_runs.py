"""Episodes of run folders: finished ones, and what there is of one that was interrupted or damaged."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from airhockey.errors import ConfigurationError
from airhockey.viewing.library import Entry, Library

if TYPE_CHECKING:
    from airhockey.evaluator.runs.manifest import Manifest
    from airhockey.evaluator.runs.records import EpisodeRecord, Options
    from airhockey.viewing.recording import Recording


def add_run(library: Library) -> None:
    """Add the episodes of a run folder, if it is one."""
    from airhockey.evaluator.runs.journal import read_journal
    from airhockey.evaluator.runs.records import EpisodeRecord
    from airhockey.evaluator.runs.trajectories import TRAJECTORIES

    path = library.path
    merged = path / TRAJECTORIES
    files = [merged] if merged.exists() else sorted((path / "trajectories").glob("*.h5"))
    if not files and not (path / "run.json").exists():
        return
    manifest = _manifest(library)
    player = Path(manifest.options.agent).name if manifest else "agent"
    found: list[tuple[EpisodeRecord, Path]] = []
    for file in files:
        found += [(record, file) for record in _records(library, file)]
    found.sort(key=lambda pair: (_place(manifest, pair[0].env), pair[0].index))
    several = len({record.env for record, _ in found}) > 1
    for record, file in found:
        if record.steps:
            name = f"{record.env}/{record.index}" if several else str(record.index)
            library.entries.append(Entry(name, _loader(name, file, record, player)))
        else:
            library.notes.append(f"episode {record.index} of {record.env} has no steps: {record.error}")
    noted = len(read_journal(path, EpisodeRecord).records)
    _say_what_is_missing(library, manifest, len(found), noted)


def _manifest(library: Library) -> "Manifest[Options] | None":
    from airhockey.evaluator.runs.manifest import RUN, read_manifest
    from airhockey.evaluator.runs.records import Options

    try:
        return read_manifest(library.path, RUN, Options)
    except ConfigurationError as error:
        library.notes.append(str(error))
        return None


def _records(library: Library, file: Path) -> "list[EpisodeRecord]":
    import msgspec

    from airhockey.evaluator.runs import trajectories

    try:
        return trajectories.read_records(file)
    except (OSError, KeyError, msgspec.MsgspecError) as error:
        library.notes.append(f"{file.name} cannot be read: {' '.join(str(error).split())}")
        return []


def _place(manifest: "Manifest[Options] | None", env: str) -> tuple[int, str]:
    order = manifest.options.environments if manifest else ()
    return (order.index(env) if env in order else len(order)), env


def _loader(name: str, file: Path, record: "EpisodeRecord", player: str) -> "Callable[[], Recording]":
    from airhockey.evaluator.runs import trajectories
    from airhockey.viewing.episodes import Outcome, episode_recording

    def load() -> "Recording":
        arrays = trajectories.read_episode(file, record.env, record.index)
        title = f"{record.env}, episode {record.index}"
        outcome = Outcome(record.success, record.error)
        return episode_recording(name, record.env, player, arrays, outcome, title)

    return load


def _say_what_is_missing(library: Library, manifest: "Manifest[Options] | None", found: int, noted: int) -> None:
    if manifest is not None:
        asked = manifest.options.episodes * len(manifest.options.environments)
        if found < asked:
            library.notes.append(f"the run is not finished: {found} of its {asked} episodes are there")
    if noted > found:
        library.notes.append(f"the journal names {noted} episodes, but trajectories are there of {found}")
