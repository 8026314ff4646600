"""The judge: penalty points, deployability and scores from records alone."""

import math
from collections.abc import Iterable, Mapping

from airhockey.envs.editions import Edition
from airhockey.evaluator.runs.records import EpisodeRecord

CLASSES = ("Deployable", "Improvable", "Non-deployable")  # from best to worst
PHASES = {"3dof": "phase-1", "7dof": "phase-2"}


def penalty(record: EpisodeRecord, rules: Edition) -> float:
    """Penalty points of an episode; a constraint counts once, however often it is violated."""
    points = sum(rules.penalty_points[name] for name, steps in record.violations.items() if steps)
    time = record.computation_time
    return points + rules.time_penalty(time.max, time.mean)


def violated_episodes(records: Iterable[EpisodeRecord]) -> dict[str, int]:
    """Constraint name -> number of episodes that violated it."""
    episodes: dict[str, int] = {}
    for record in records:
        for name, steps in record.violations.items():
            episodes[name] = episodes.get(name, 0) + bool(steps)
    return episodes


def worst_class(classes: Iterable[str]) -> str:
    """The class of a whole: the worst of its parts."""
    return max(classes, key=CLASSES.index)


def score(success: Mapping[str, float], rules: Edition) -> tuple[str | None, float | None]:
    """The phase whose tasks these are, and its weighted score.

    Args:
        success: Environment name -> share of successes, 0 … 1.
        rules: Hold the weights.

    Returns:
        Phase and score, 0 … 1; None and None unless the environments are the tasks of one phase.
    """
    for robot, weights in rules.score_weights.items():
        if weights.keys() == success.keys():
            return PHASES[robot], sum(weight * success[env] for env, weight in weights.items())
    return None, None


def wilson_interval(successes: int, trials: int, z: float = 1.959964) -> tuple[float, float]:
    """The interval that holds a binomial share with 95 % confidence (Wilson 1927).

    Args:
        successes: Number of successes.
        trials: Number of trials, ≥ 1.
        z: Quantile of the normal distribution.
    """
    share = successes / trials
    centre = share + z * z / (2 * trials)
    spread = z * math.sqrt(share * (1 - share) / trials + z * z / (4 * trials * trials))
    scale = 1 + z * z / trials
    return max(0.0, (centre - spread) / scale), min(1.0, (centre + spread) / scale)
