"""Results, read back from what a finished run stored."""

from collections import Counter
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.editions import edition
from airhockey.evaluator.judging import tasks as judging
from airhockey.evaluator.runs import trajectories
from airhockey.evaluator.runs.folder import TRAJECTORIES, read_journal, read_manifest
from airhockey.evaluator.runs.records import EpisodeRecord, Manifest, RunResult, RunTime, TaskResult


def report(path: Path) -> TaskResult | RunResult:
    """The result of a finished run: of its task, or of its tasks and the whole.

    Args:
        path: The run folder.
    """
    manifest = read_manifest(path)
    by_env: dict[str, list[EpisodeRecord]] = {env: [] for env in manifest.options.environments}
    for record in read_journal(path):
        by_env[record.env].append(record)
    results = tuple(_task_result(path, manifest, env, records) for env, records in by_env.items())
    if len(results) == 1:
        return results[0]
    rules = edition(manifest.options.edition)
    phase, score = judging.score({result.env: result.success for result in results}, rules)
    worst = judging.worst_class(result.deployability for result in results)
    return RunResult(results=results, deployability=worst, phase=phase, score=score)


def task_results(result: TaskResult | RunResult) -> tuple[TaskResult, ...]:
    """The results of the single tasks."""
    return result.results if isinstance(result, RunResult) else (result,)


def failure_reasons(path: Path, most: int = 3) -> list[tuple[str, int]]:
    """Why the agent failed episodes, the most frequent reasons first, each with its number of episodes."""
    reasons = Counter(record.error for record in read_journal(path) if record.error is not None)
    return reasons.most_common(most)


def _task_result(path: Path, manifest: Manifest, env: str, records: list[EpisodeRecord]) -> TaskResult:
    options = manifest.options
    rules = edition(options.edition)
    points = sum(judging.penalty(record, rules) for record in records)
    return TaskResult(
        env=env,
        agent=options.agent,
        episodes=len(records),
        seed=options.seed,
        disturbances=options.disturbances,
        success=sum(record.success for record in records) / len(records),
        penalty=points,
        deployability=rules.deployability.class_of(points),
        violations=judging.violated_episodes(records),
        computation_time=_run_time(trajectories.read_steps(path / TRAJECTORIES, env, "computation_time")),
        agent_errors=sum(record.error is not None for record in records),
    )


def _run_time(seconds: NDArray[np.float64]) -> RunTime:
    """Mean, 99th percentile and maximum over all steps, in [s]; zeros where no step was played."""
    if seconds.size == 0:
        return RunTime(mean=0.0, p99=0.0, max=0.0)
    return RunTime(mean=float(seconds.mean()), p99=float(np.percentile(seconds, 99)), max=float(seconds.max()))
