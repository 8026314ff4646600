"""The result of one task of a run, from its records, for every page that shows one."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from airhockey.envs.editions import Edition, available, edition
from airhockey.evaluator.judging.tasks import COMPUTATION_TIME, Verdict, judge
from airhockey.evaluator.runs.reader import Run
from airhockey.evaluator.runs.records import EpisodeRecord
from airhockey.reporting.episodes import TaskData


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

    @cached_property
    def verdict(self) -> Verdict:
        """The judge's."""
        return judge(self.records, self.rules)

    @property
    def violations(self) -> dict[str, int]:
        """Constraint name -> number of episodes that violated it; "computation_time" among them."""
        return {**self.verdict.violations, COMPUTATION_TIME: self.verdict.late}

    @cached_property
    def computation_time(self) -> tuple[float, float | None, float]:
        """Mean, 99th percentile (where the trajectories are there) and maximum of `draw_action`, in [s]."""
        longest = max(record.computation_time.max for record in self.records)
        steps = sum(record.steps for record in self.records)
        mean = sum(record.computation_time.mean * record.steps for record in self.records) / max(steps, 1)
        p99 = float(np.percentile(self.data.times, 99)) if self.data is not None else None
        return mean, p99, longest
