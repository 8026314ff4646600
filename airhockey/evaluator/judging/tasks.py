"""The judge of tasks: penalty points, deployability and scores from records alone.

Terminal, `result.json`, report and leaderboard all ask `judge`.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from airhockey.envs.editions import Edition
from airhockey.evaluator.runs.records import EpisodeRecord

CLASSES = ("Deployable", "Improvable", "Non-deployable")  # from best to worst
OFFICIAL_EPISODES = 1000
"""What the limits of the deployability classes are made for."""
COMPUTATION_TIME = "computation_time"


@dataclass(frozen=True)
class Verdict:
    """What the episodes of a task amount to.

    Attributes:
        episodes, successes, failures: How many there are, how many succeeded, and how many the agent failed.
        penalty: Points of all of them.
        deployability: Class of the points as they are.
        official_class: Class of the points at the rate of an official evaluation.
        violations: Constraint name -> number of episodes that violated it.
        late: Episodes that cost points for computation time.
    """

    episodes: int
    successes: int
    failures: int
    penalty: float
    deployability: str
    official_class: str
    violations: dict[str, int]
    late: int

    @property
    def success(self) -> float:
        """Share of the episodes that succeeded."""
        return self.successes / self.episodes


def judge(records: Sequence[EpisodeRecord], rules: Edition) -> Verdict:
    """Judge the episodes of a task, at least one."""
    points = sum(penalty(record, rules) for record in records)
    return Verdict(
        episodes=len(records),
        successes=sum(record.success for record in records),
        failures=sum(record.error is not None for record in records),
        penalty=points,
        deployability=rules.deployability.class_of(points),
        official_class=rules.deployability.class_of(points * OFFICIAL_EPISODES / len(records)),
        violations=violated_episodes(records),
        late=sum(bool(_time_penalty(record, rules)) for record in records),
    )


def penalty(record: EpisodeRecord, rules: Edition) -> float:
    """Penalty points of an episode; a constraint counts once, however often it is violated, and one without a price nothing."""
    points = sum(rules.penalty_points.get(name, 0.0) for name, steps in record.violations.items() if steps)
    return points + _time_penalty(record, rules)


def _time_penalty(record: EpisodeRecord, rules: Edition) -> float:
    return rules.time_penalty(record.computation_time.max, record.computation_time.mean)


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
            return rules.phases[robot], weighted(success, weights)
    return None, None


def weighted(success: Mapping[str, float], weights: Mapping[str, float]) -> float:
    """The score of tasks with these weights, 0 … 1; both by environment."""
    return sum(weight * success[env] for env, weight in weights.items())


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
