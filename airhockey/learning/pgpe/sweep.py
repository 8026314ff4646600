"""One-θ sweeps: what a run's episodes are worth when one parameter goes through its range and the others stay."""

from collections.abc import Sequence
from dataclasses import dataclass

import msgspec
import numpy as np
from numpy.typing import NDArray

from airhockey.errors import AirHockeyError
from airhockey.evaluator.engines.engine import InProcess
from airhockey.evaluator.engines.pool import JobFailed
from airhockey.evaluator.engines.processes import Processes
from airhockey.learning.pgpe.records import Outcome, PgpeManifest, RolloutJob, Settings
from airhockey.learning.pgpe.rollouts import Rollouts
from airhockey.learning.pgpe.trainable import ranges

Array = NDArray[np.float64]

_SWEEP = 2**31
"""In place of an iteration's number, so that a sweep plays episodes that were not trained on."""


@dataclass(frozen=True)
class SweepPoint:
    """What one value of the parameter was worth.

    Attributes:
        value: Of the parameter.
        returns: Mean return.
        deviation: Its standard error.
        success: Share of successes.
        penalty: Points per episode.
    """

    value: float
    returns: float
    deviation: float
    success: float
    penalty: float


def sweep(
    manifest: PgpeManifest[Settings],
    mean: Sequence[float],
    name: str,
    points: int,
    episodes: int,
    engine: InProcess | Processes | None = None,
) -> list[SweepPoint]:
    """Play the same episodes with each value of a parameter.

    Args:
        manifest: The run's.
        mean: Values of all the parameters that it trains.
        name: Of the one to vary, from its lower to its upper bound.
        points: How many values.
        episodes: Played with each.
        engine: Where they are played.
    """
    settings = msgspec.structs.replace(manifest.options, common_random_numbers=True)
    column = settings.names.index(name)
    values = np.linspace(ranges()[name].lower, ranges()[name].upper, points)
    jobs = []
    for index, value in enumerate(values):
        theta = (*mean[:column], float(value), *mean[column + 1 :])
        jobs += [RolloutJob(_SWEEP, index, episode, theta) for episode in range(episodes)]
    outcomes: list[dict[int, Outcome]] = [{} for _ in values]
    player = Rollouts(msgspec.structs.replace(manifest, options=settings))
    for job, outcome in (engine or InProcess()).run(player, jobs):
        if isinstance(outcome, JobFailed) or outcome.error is not None:
            why = outcome.reason if isinstance(outcome, JobFailed) else outcome.error
            raise AirHockeyError(f"the player failed with {name} = {values[job.candidate]:g}: {why}")
        outcomes[job.candidate][job.episode] = outcome
    return [_point(value, [one[k] for k in range(episodes)]) for value, one in zip(values, outcomes, strict=True)]


def _point(value: float, outcomes: list[Outcome]) -> SweepPoint:
    returns = np.array([one.value for one in outcomes])
    return SweepPoint(
        value=float(value),
        returns=float(returns.mean()),
        deviation=float(returns.std() / np.sqrt(returns.size)),
        success=float(np.mean([one.success for one in outcomes])),
        penalty=float(np.mean([one.penalty for one in outcomes])),
    )
