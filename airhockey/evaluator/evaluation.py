"""A run from options to result: prepare everything that can go wrong first, play what is not played yet, report."""

import contextlib
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.disturbances import load_disturbances
from airhockey.envs.editions import edition
from airhockey.envs.specs import CONTROL_PERIOD
from airhockey.evaluator.checks import check_options
from airhockey.evaluator.engines.engine import Engine, InProcess
from airhockey.evaluator.engines.pool import JobFailed
from airhockey.evaluator.judging import tasks as judging
from airhockey.evaluator.play.blame import worker_lost
from airhockey.evaluator.play.episode import EpisodePlayer, failed
from airhockey.evaluator.runs.episode_folder import EpisodeFolder
from airhockey.evaluator.runs.journal import read_journal
from airhockey.evaluator.runs.manifest import Manifest
from airhockey.evaluator.runs.records import (
    Episode,
    EpisodeRecord,
    Job,
    Options,
    PreparationTime,
    RunResult,
    RunTime,
    TaskResult,
    isolation_of,
)
from airhockey.evaluator.runs.trajectories import TRAJECTORIES, read_steps

OnEpisode = Callable[[EpisodeRecord], None]
Result = TaskResult | RunResult

begin = EpisodeFolder.begin
resume = EpisodeFolder.resume


def evaluate(folder: EpisodeFolder, engine: Engine | None = None, on_episode: OnEpisode | None = None) -> Result:
    """Play the episodes of a run that are not played yet, and report on all of them.

    Args:
        folder: From `begin` or `resume`; it is closed afterwards.
        engine: Where the episodes are played; here, one by one, if not given.
        on_episode: Called with every record as it comes.

    Raises:
        AirHockeyError: The disk is full.
        EnvironmentFault: The environment, its disturbances or this machine failed; everything played so far is kept.
        KeyboardInterrupt: The user's; everything played so far is kept.
    """
    manifest = folder.manifest
    with folder:
        everything = jobs(manifest.options)
        folder.check_work(everything)
        missing = [job for job in everything if job not in folder.done]
        results = (engine or InProcess()).run(EpisodePlayer(manifest.options, manifest.profile), missing)
        with contextlib.closing(results):
            for job, result in results:
                episode = _lost(job, result, manifest.options) if isinstance(result, JobFailed) else result
                folder.add(episode)
                if on_episode is not None:
                    on_episode(episode.record)
        folder.merge()
        result_of_all = report(folder.path)
        folder.keep_result(result_of_all)
    return result_of_all


def _lost(job: Job, result: JobFailed, options: Options) -> Episode:
    """An episode whose worker died every time; the agent's failure where its code ran there."""
    worker_lost((options.agent,), options.isolate, result.reason)
    return failed(job, result.reason, options.edition)


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


def jobs(options: Options) -> list[Job]:
    """The episodes of a run."""
    return [Job(env, index) for env in options.environments for index in range(options.episodes)]


def report(path: Path) -> Result:
    """The result of a finished run, from what it stored: of its task, or of its tasks and the whole.

    Args:
        path: The run folder.
    """
    manifest = EpisodeFolder.read(path)
    options = manifest.options
    by_env: dict[str, list[EpisodeRecord]] = {env: [] for env in options.environments}
    for record in read_journal(path, EpisodeRecord).records:
        by_env[record.env].append(record)
    results = tuple(_task_result(path, manifest, env, records) for env, records in by_env.items())
    if len(results) == 1:
        return results[0]
    phase, score = judging.score({result.env: result.success for result in results}, edition(options.edition))
    worst = judging.worst_class(result.deployability for result in results)
    return RunResult(results=results, deployability=worst, phase=phase, score=score, edition=options.edition)


def failure_reasons(path: Path, most: int = 3) -> list[tuple[str, int]]:
    """Why the agent failed episodes, the most frequent reasons first, each with its number of episodes."""
    records = read_journal(path, EpisodeRecord).records
    return Counter(record.error for record in records if record.error is not None).most_common(most)


def _task_result(path: Path, manifest: Manifest[Options], env: str, records: list[EpisodeRecord]) -> TaskResult:
    options = manifest.options
    verdict = judging.judge(records, edition(options.edition))
    return TaskResult(
        env=env,
        agent=options.agent,
        episodes=verdict.episodes,
        seed=options.seed,
        disturbances=options.disturbances,
        success=verdict.success,
        penalty=verdict.penalty,
        deployability=verdict.deployability,
        violations=verdict.violations,
        computation_time=_run_time(read_steps(path / TRAJECTORIES, env, "computation_time")),
        agent_errors=verdict.failures,
        inputs=manifest.inputs,
        edition=options.edition,
        isolation=isolation_of(record.process for record in records),
        preparation_time=PreparationTime(
            build_agent=max((record.process.build_time for record in records), default=0.0),
            episode_start=max((record.process.start_time for record in records), default=0.0),
        ),
    )


def _run_time(seconds: NDArray[np.float64]) -> RunTime:
    """What the clock saw over all steps; zeros where no step was played."""
    if seconds.size == 0:
        return RunTime(mean=0.0, p99=0.0, max=0.0)
    return RunTime(
        mean=float(seconds.mean()),
        p99=float(np.percentile(seconds, 99)),
        max=float(seconds.max()),
        late=int((seconds > CONTROL_PERIOD).sum()),
    )
