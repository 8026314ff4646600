"""A sweep: some agents under some disturbances with some seeds, as one run, and which of them differ.

sweep.json        the manifest: every run's options
journal.jsonl     a line per finished run
AGENT-PROFILE-sSEED/      the runs, each as `hockey evaluate` leaves it
result.json       once everything is played
"""

import itertools
import math
import shutil
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import msgspec

from airhockey.envs.editions import DEFAULT, edition
from airhockey.errors import ConfigurationError
from airhockey.evaluator.engines.engine import Engine
from airhockey.evaluator.evaluation import OnEpisode, evaluate
from airhockey.evaluator.judging.statistics import compare_pairs, holm
from airhockey.evaluator.judging.tasks import judge, wilson_interval
from airhockey.evaluator.runs import notebook
from airhockey.evaluator.runs.episode_folder import EpisodeFolder
from airhockey.evaluator.runs.folder import RunFolder
from airhockey.evaluator.runs.journal import read_journal
from airhockey.evaluator.runs.manifest import RUN, SWEEP
from airhockey.evaluator.runs.records import EpisodeRecord, Options

Progress = Callable[[str, EpisodeFolder], AbstractContextManager[OnEpisode | None]]
"""Shows how far a run is, from its heading and its folder."""


class SweepOptions(msgspec.Struct, frozen=True, kw_only=True):
    """What a sweep is.

    Attributes:
        agents: Names of the registry, or absolute paths of submissions.
        profiles: Disturbances: names, or absolute paths of files.
        seeds: How many; they follow each other.
        runs: For every agent, under all disturbances, with every seed.
    """

    agents: tuple[str, ...]
    profiles: tuple[str, ...]
    seeds: int
    runs: tuple[Options, ...]

    @property
    def names(self) -> list[str]:
        """Of the runs, as of their folders."""
        plain = [f"{Path(run.agent).name}-{Path(run.disturbances).stem}-s{run.seed}" for run in self.runs]
        count: Counter[str] = Counter()
        names = []
        for name in plain:
            count[name] += 1
            names.append(name if count[name] == 1 else f"{name}-{count[name]}")
        return names


class SweptRun(msgspec.Struct, frozen=True):
    """One line of the journal: a run that is finished."""

    name: str

    @property
    def key(self) -> str:
        """Names it in the sweep."""
        return self.name


class Cell(msgspec.Struct, frozen=True, kw_only=True):
    """An agent in one task under one profile, over all seeds.

    Attributes:
        success: Share of the episodes, 0 … 1; `low` and `high` are its 95 % interval (Wilson).
        spread: Standard deviation of the seeds' shares; None where there is one seed.
        penalty: Points, summed over the episodes.
        deployability: Class of the points at the rate of an official evaluation.
        agent_errors: Episodes that the agent failed.
    """

    agent: str
    env: str
    disturbances: str
    seeds: int
    episodes: int
    success: float
    low: float
    high: float
    spread: float | None
    penalty: float
    deployability: str
    agent_errors: int


class Comparison(msgspec.Struct, frozen=True, kw_only=True):
    """Two agents over the same episodes.

    Attributes:
        difference: Success of the first less that of the second; `low` and `high` are its 95 % interval (Newcombe, pairs).
        only_first, only_second: Episodes that one of them won and the other did not.
        p_value: Of the exact McNemar test.
        adjusted: By Holm, for all comparisons of the sweep: the chance of even one false alarm among them stays what it was.
    """

    env: str
    disturbances: str
    first: str
    second: str
    difference: float
    low: float
    high: float
    only_first: int
    only_second: int
    p_value: float
    adjusted: float


class SweepResult(msgspec.Struct, frozen=True, kw_only=True):
    """What `hockey evaluate --json` prints of several agents, disturbances or seeds."""

    cells: tuple[Cell, ...]
    comparisons: tuple[Comparison, ...]
    inputs: dict[str, str] = {}
    edition: str = DEFAULT

    def _repr_html_(self) -> str:
        cells = notebook.table(
            "success",
            ("agent", "task", "disturbances", "episodes", "success", "95 % interval", "penalty", "class"),
            (
                (cell.agent, cell.env, cell.disturbances, cell.episodes, f"{cell.success:.1%}",
                 f"{cell.low:.1%} – {cell.high:.1%}", f"{cell.penalty:g}", cell.deployability)
                for cell in self.cells
            ),
        )  # fmt: skip
        if not self.comparisons:
            return cells
        return cells + notebook.table(
            "differences on the same episodes",
            ("first", "second", "task", "disturbances", "difference", "95 % interval", "p (Holm)"),
            (
                (one.first, one.second, one.env, one.disturbances, f"{100 * one.difference:+.1f} points",
                 f"{100 * one.low:+.1f} … {100 * one.high:+.1f}", f"{one.adjusted:.3g}")
                for one in self.comparisons
            ),
        )  # fmt: skip


class SweepFolder(RunFolder[SweepOptions, SweptRun]):
    """The folder of a sweep, opened for writing."""

    name, options_type, record_type = SWEEP, SweepOptions, SweptRun

    @classmethod
    def check(cls, options: SweepOptions) -> None:
        """Find the mistakes in a sweep's options; raises `ConfigurationError`."""
        for what, given in (("agent", options.agents), ("disturbances", options.profiles)):
            twice = [name for name, times in Counter(given).items() if times > 1]
            if twice:
                raise ConfigurationError(f"{what} {twice[0]!r} is given twice: name each once")
        for run in options.runs:
            EpisodeFolder.check(run)
        years = {run.edition: run.agent for run in options.runs}
        if len(years) > 1:
            made_for = ", ".join(f"{agent} for {year}" for year, agent in years.items())
            raise ConfigurationError(f"agents of several editions ({made_for}): say whose rules apply, with --edition")

    def run(self, name: str, options: Options) -> EpisodeFolder:
        """One of its runs, taken up again where it was begun."""
        path = self.path / name
        if (path / RUN).exists():
            return EpisodeFolder.resume(path)
        shutil.rmtree(path, ignore_errors=True)  # what a kill left before there was a manifest
        return EpisodeFolder.begin(options, path)


begin_sweep = SweepFolder.begin
resume_sweep = SweepFolder.resume


def sweep(folder: SweepFolder, progress: Progress, engine: Engine | None = None) -> SweepResult:
    """Play the runs that are not played yet, and compare all of them.

    Args:
        folder: From `begin_sweep` or `resume_sweep`; it is closed afterwards.
        progress: Shows how far each run is.
        engine: Where episodes are played; here, one by one, if not given.

    Raises:
        AirHockeyError: The disk is full.
        EnvironmentFault: The environment, its disturbances or this machine failed; everything played so far is kept.
    """
    options = folder.manifest.options
    with folder:
        folder.check_work(options.names)
        for number, (name, run) in enumerate(zip(options.names, options.runs, strict=True), start=1):
            if name in folder.done:
                continue
            opened = folder.run(name, run)
            with progress(f"{name} ({number} of {len(options.runs)})", opened) as shown:
                evaluate(opened, engine, shown)
            folder.keep(SweptRun(name))
        result = sweep_result(folder.path)
        folder.keep_result(result)
    return result


def sweep_result(path: Path) -> SweepResult:
    """The result of a finished sweep, from what its runs stored."""
    manifest = SweepFolder.read(path)
    options = manifest.options
    records: dict[tuple[str, str, str], dict[tuple[int, int], EpisodeRecord]] = {}
    for name, run in zip(options.names, options.runs, strict=True):
        for record in read_journal(path / name, EpisodeRecord).records:
            cell = records.setdefault((record.env, run.disturbances, run.agent), {})
            cell[run.seed, record.index] = record
    comparisons = list(_comparisons(options, records))
    adjusted = holm([one.p_value for one in comparisons])
    return SweepResult(
        cells=tuple(_cell(*where, found) for where, found in records.items()),
        comparisons=tuple(
            msgspec.structs.replace(one, adjusted=value) for one, value in zip(comparisons, adjusted, strict=True)
        ),
        inputs=manifest.inputs,
        edition=options.runs[0].edition,
    )


def _cell(env: str, profile: str, agent: str, records: dict[tuple[int, int], EpisodeRecord]) -> Cell:
    everything = list(records.values())
    verdict = judge(everything, edition(everything[0].edition))
    low, high = wilson_interval(verdict.successes, verdict.episodes)
    seeds = sorted({seed for seed, _ in records})
    shares = [_share([record for (of, _), record in records.items() if of == seed]) for seed in seeds]
    mean = sum(shares) / len(shares)
    squares = sum((share - mean) ** 2 for share in shares)
    return Cell(
        agent=agent,
        env=env,
        disturbances=profile,
        seeds=len(seeds),
        episodes=verdict.episodes,
        success=verdict.success,
        low=low,
        high=high,
        spread=math.sqrt(squares / (len(shares) - 1)) if len(shares) > 1 else None,
        penalty=verdict.penalty,
        deployability=verdict.official_class,
        agent_errors=verdict.failures,
    )


def _share(records: list[EpisodeRecord]) -> float:
    return sum(record.success for record in records) / len(records)


def _comparisons(
    options: SweepOptions, records: dict[Any, dict[tuple[int, int], EpisodeRecord]]
) -> Iterator[Comparison]:
    """Every pair of agents in every task under every profile, episode by episode."""
    for (env, profile), (first, second) in itertools.product(
        dict.fromkeys((env, profile) for env, profile, _ in records), itertools.combinations(options.agents, 2)
    ):
        one, other = records[env, profile, first], records[env, profile, second]
        won = Counter((one[key].success, other[key].success) for key in one.keys() & other.keys())
        found = compare_pairs(won[True, True], won[True, False], won[False, True], won[False, False])
        yield Comparison(
            env=env,
            disturbances=profile,
            first=first,
            second=second,
            difference=found.estimate,
            low=found.low,
            high=found.high,
            only_first=won[True, False],
            only_second=won[False, True],
            p_value=found.p_value,
            adjusted=found.p_value,
        )
