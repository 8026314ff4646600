"""A run from options to result: prepare everything that can go wrong first, play what is not played yet, report."""

import contextlib
import datetime
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from airhockey import envs
from airhockey.envs.disturbances import load_disturbances
from airhockey.errors import ConfigurationError
from airhockey.evaluator.checks import check_options, check_versions
from airhockey.evaluator.engines.engine import Engine, InProcess, JobFailed
from airhockey.evaluator.play.episode import EpisodePlayer, failed
from airhockey.evaluator.results import report
from airhockey.evaluator.runs.folder import RunFolder, read_manifest
from airhockey.evaluator.runs.records import Episode, EpisodeRecord, Job, Manifest, Options, RunResult, TaskResult

OnEpisode = Callable[[EpisodeRecord], None]


def begin(options: Options, path: Path) -> RunFolder:
    """Begin a run; nothing is written when anything about it is wrong.

    Raises:
        ConfigurationError: An option has no meaning, or the folder holds something or cannot be written.
    """
    check_options(options)
    manifest = Manifest(
        options=options,
        profile=load_disturbances(options.disturbances),
        versions=envs.versions(),
        created=datetime.datetime.now().astimezone().isoformat(timespec="seconds"),
    )
    return RunFolder.create(path, manifest)


def resume(path: Path, asked: Mapping[str, Any] | None = None) -> RunFolder:
    """Take up a run that was interrupted.

    Args:
        path: Its folder.
        asked: Fields of `Options` that the user repeated; they must be the run's.

    Raises:
        ConfigurationError: There is no run, it is another than the one asked for, or the software is.
    """
    manifest = read_manifest(path)
    for name, value in (asked or {}).items():
        began_with = getattr(manifest.options, name)
        same = load_disturbances(value) == manifest.profile if name == "disturbances" else value == began_with
        if not same:
            raise ConfigurationError(f"the run in {str(path)!r} has {name} {began_with!r}, not {value!r}")
    check_versions(manifest.versions, path)
    return RunFolder.open(path)


def evaluate(
    folder: RunFolder, engine: Engine | None = None, on_episode: OnEpisode | None = None
) -> TaskResult | RunResult:
    """Play the episodes of a run that are not played yet, and report on all of them.

    Args:
        folder: From `begin` or `resume`; it is closed afterwards.
        engine: Where the episodes are played; here, one by one, if not given.
        on_episode: Called with every record as it comes.

    Raises:
        AirHockeyError: The disk is full, or workers do not start.
        KeyboardInterrupt: The user's; everything played so far is kept.
    """
    manifest = folder.manifest
    with folder:
        results = (engine or InProcess()).run(EpisodePlayer(manifest.options, manifest.profile), _unplayed(folder))
        with contextlib.closing(results):
            for job, result in results:
                episode = failed(job, result.reason) if isinstance(result, JobFailed) else result
                folder.add(episode)
                if on_episode is not None:
                    on_episode(episode.record)
        folder.merge()
        result_of_all = report(folder.path)
        folder.keep_result(result_of_all)
    return result_of_all


def play_episode(options: Options, env: str, index: int) -> Episode:
    """Play one episode of a run alone, as it is in the run.

    Raises:
        ConfigurationError: An option has no meaning.
    """
    check_options(options)
    player = EpisodePlayer(options, load_disturbances(options.disturbances))
    try:
        return player(Job(env, index))
    finally:
        player.close()


def _unplayed(folder: RunFolder) -> list[Job]:
    options, done = folder.manifest.options, folder.done
    jobs = [Job(env, index) for env in options.environments for index in range(options.episodes)]
    return [job for job in jobs if job not in done]
