"""The result of one task of a run, from its records, for every page that shows one."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from airhockey.envs.editions import Edition, available, edition
from airhockey.evaluator.judging import tasks as judging
from airhockey.evaluator.runs.reader import Run
from airhockey.evaluator.runs.records import EpisodeRecord
from airhockey.reporting.episodes import TaskData

OFFICIAL_EPISODES = 1000
"""What the limits of the deployability classes are made for."""


@dataclass(frozen=True)
class Task:
    """One task of a run.

    Attributes:
        run: The run.
        label: Tells the run from the others on the page.
        env: Name of the environment.
        records: Of the finished episodes; at least one.
        data: Of the trajectories; None where there are none.
    """

    run: Run
    label: str
    env: str
    records: Sequence[EpisodeRecord]
    data: TaskData | None = None

    @cached_property
    def rules(self) -> Edition:
        """Of the run's edition; of the first one where the run's is not known here."""
        asked = self.run.manifest.options.edition if self.run.manifest else ""
        return edition(asked if asked in available() else available()[0])

    @property
    def episodes(self) -> int:
        """How many there are."""
        return len(self.records)

    @cached_property
    def successes(self) -> int:
        """Episodes that ended in success."""
        return sum(record.success for record in self.records)

    @property
    def success(self) -> float:
        """Their share."""
        return self.successes / self.episodes

    @cached_property
    def penalty(self) -> float:
        """Penalty points; a constraint that the rules do not know costs nothing."""
        known = self.rules.penalty_points
        points = 0.0
        for record in self.records:
            time = record.computation_time
            points += sum(known.get(name, 0.0) for name, steps in record.violations.items() if steps)
            points += self.rules.time_penalty(time.max, time.mean)
        return points

    @property
    def deployability(self) -> str:
        """The class of the penalty at the rate of an official evaluation."""
        return self.rules.deployability.class_of(self.penalty * OFFICIAL_EPISODES / self.episodes)

    @cached_property
    def violations(self) -> dict[str, int]:
        """Constraint name -> number of episodes that violated it; "computation_time" among them."""
        late = sum(bool(self.rules.time_penalty(r.computation_time.max, r.computation_time.mean)) for r in self.records)
        return {**judging.violated_episodes(self.records), "computation_time": late}

    @cached_property
    def computation_time(self) -> tuple[float, float | None, float]:
        """Mean, 99th percentile (where the trajectories are there) and maximum of `draw_action`, in [s]."""
        longest = max(record.computation_time.max for record in self.records)
        steps = sum(record.steps for record in self.records)
        mean = sum(record.computation_time.mean * record.steps for record in self.records) / max(steps, 1)
        p99 = float(np.percentile(self.data.times, 99)) if self.data is not None else None
        return mean, p99, longest

    @property
    def failures(self) -> int:
        """Episodes that the agent failed."""
        return sum(record.error is not None for record in self.records)
