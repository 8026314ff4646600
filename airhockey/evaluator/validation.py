"""Is a submission fit to be handed in? Load it apart from everything, play a little, and say what to mend, and how."""

import functools
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from airhockey import envs
from airhockey.agents.packaging.metadata import METADATA, Metadata, interpolation_order, read_metadata
from airhockey.agents.packaging.packing import contents
from airhockey.agents.submission import CONFIG, submission_config, submission_folder
from airhockey.errors import ActionError, AirHockeyError, ConfigurationError
from airhockey.evaluator.isolation.failures import AgentDied, AgentTimeout, describe
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.isolation.modes import Mode
from airhockey.evaluator.play.build_seats import Entrant, build_seats
from airhockey.evaluator.play.game import TIME_LIMIT
from airhockey.evaluator.play.rollout import Rollout
from airhockey.evaluator.play.seat import Care


class Problem(msgspec.Struct, frozen=True):
    """Something to mend.

    Attributes:
        where: A file or a task.
        what: Is wrong.
        remedy: What to do about it.
    """

    where: str
    what: str
    remedy: str


class Trial(msgspec.Struct, frozen=True):
    """A task that was played for a little.

    Attributes:
        steps: Played.
        start: Time to load and build the agent, in [s].
        median, longest: Of `draw_action`, in [s], the first step apart: something may be compiled there.
        first: `draw_action` of the first step, in [s].
        longest_cpu: CPU time of the step that used most of it, in [s]; on a busy machine it says more than the wall clock.
    """

    env: str
    steps: int
    start: float
    median: float
    longest: float
    first: float
    longest_cpu: float


class Verdict(msgspec.Struct, frozen=True):
    """What validation found.

    Attributes:
        left_out: File -> why `hockey package` leaves it out.
    """

    name: str
    problems: tuple[Problem, ...]
    trials: tuple[Trial, ...]
    left_out: dict[str, str]


def validate(path: Path, mode: Mode, limits: Limits, steps: int = 50) -> Verdict:
    """Look at a submission and let it play.

    Args:
        path: Folder or archive.
        mode: Where its code runs.
        limits: What it may use, and how long anybody waits.
        steps: Control steps of each task.
    """
    problems: list[Problem] = []
    trials: list[Trial] = []
    left_out: dict[str, str] = {}
    try:
        folder = submission_folder(path)
    except ConfigurationError as error:
        remedy = "`hockey new DIR` makes a folder as it should be, `hockey package DIR` an archive"
        return Verdict(path.name, (Problem(path.name, str(error), remedy),), (), {})
    metadata, found = _paper(folder)
    problems += found
    if path.is_dir():
        try:
            left_out = contents(path)[1]
        except ConfigurationError as error:
            problems.append(
                Problem(path.name, str(error), "see the names and sizes above; `hockey package` needs this")
            )
    if not any(problem.where == CONFIG for problem in problems):
        for task in metadata.tasks if metadata is not None else ("7dof-hit",):
            outcome = try_out(str(path.resolve()), task, mode, limits, steps)
            if isinstance(outcome, Trial):
                trials.append(outcome)
                problems += _slow(outcome)
            else:
                problems.append(outcome)
    return Verdict(metadata.name if metadata else path.name, tuple(problems), tuple(trials), left_out)


def try_out(agent: str, task: str, mode: Mode, limits: Limits, steps: int) -> Trial | Problem:
    """Play a few steps of one task, alone or against somebody who stands still."""
    entrants = [Entrant(agent, isolate=mode, limits=limits), Entrant("hold")][: 2 if task == "tournament" else 1]
    began = time.perf_counter()
    env, seats = build_seats(functools.partial(envs.make, task), entrants, Care())
    start, seat, rollout = time.perf_counter() - began, seats[0], Rollout(env, seats, seed=0)
    if seat.agent is None or seat.error is not None:
        return _problem(task, rollout, limits)
    times, cpu_times = list[float](), list[float]()
    wall, cpu = seat.clock, seat.agent.clock("cpu")

    def both() -> float:
        """The wall clock; it notes the other one, before an action and after it."""
        cpu_times.append(cpu())
        return wall()

    seat.clock = both
    rollout.begin()
    while len(times) < steps and rollout.step():
        times.append(seat.seconds)
        if rollout.over:
            rollout.begin()
    seat.stop()
    if seat.error is not None:
        return _problem(task, rollout, limits)
    rest = times[1:] or times
    longest_cpu = max(
        (after - before for before, after in zip(cpu_times[2::2], cpu_times[3::2], strict=False)), default=0.0
    )
    return Trial(task, len(times), start, float(np.median(rest)), max(rest), times[0], longest_cpu)


def _problem(task: str, rollout: Rollout, limits: Limits) -> Problem:
    """What the agent did wrong."""
    seat = rollout.seats[0]
    assert seat.error is not None
    printed = "" if seat.agent is None else seat.agent.printed
    where = f"{task}, step {rollout.steps}" if rollout.steps else f"{task}, loading"
    return Problem(where, describe(seat.error), _remedy(seat.error, printed, limits))


def _paper(folder: Path) -> tuple[Metadata | None, list[Problem]]:
    """What the submission's own files say."""
    problems: list[Problem] = []
    metadata, config = None, dict[str, Any]()
    try:
        config = submission_config(folder)
        if "interpolation_order" in config:
            interpolation_order(config["interpolation_order"])
    except ConfigurationError as error:
        problems.append(Problem(CONFIG, str(error), "write plain YAML: names, numbers, texts, lists"))
    try:
        metadata = read_metadata(folder)
    except ConfigurationError as error:
        problems.append(Problem(METADATA, str(error), "`hockey new` shows a file as it should be"))
    else:
        if metadata is None:
            problems.append(
                Problem(METADATA, "there is none", "copy the one that `hockey new DIR` writes, and fill it in")
            )
        else:
            problems += _contradictions(metadata, config)
    return metadata, problems


def _contradictions(metadata: Metadata, config: dict[str, Any]) -> Iterator[Problem]:
    for requirement in metadata.missing_packages:
        yield Problem(METADATA, f"the package {requirement!r} is not installed here", f"pip install '{requirement}'")
    named = config.get("interpolation_order", metadata.interpolation_order)
    if str(named).lower() != str(metadata.interpolation_order).lower():
        yield Problem(
            METADATA,
            f"interpolation_order is {metadata.interpolation_order!r}, but {named!r} in {CONFIG}, which wins",
            "give the same order in both",
        )


def _slow(trial: Trial) -> Iterator[Problem]:
    slow = max(trial.median, trial.longest_cpu)
    if slow > TIME_LIMIT:
        yield Problem(
            trial.env,
            f"draw_action took {slow * 1e3:.1f} ms; a control step has {TIME_LIMIT * 1e3:.0f} ms",
            "compute less per step, or spread it over several; compile and load in build_agent",
        )


def _remedy(failure: BaseException, printed: str, limits: Limits) -> str:
    """What to do about a failure, by its kind."""
    if isinstance(failure, ActionError):
        return "return a float array of the shape that the interpolation order asks for"
    if isinstance(failure, AgentTimeout):
        return f"return sooner than in {limits.patience:g} s (--patience), or in {limits.start:g} s from build_agent"
    if isinstance(failure, AgentDied):
        last = " / ".join(printed.strip().splitlines()[-3:])
        return "keep the process alive, within 4 GiB of memory" + (f"; it said: {last}" if last else "")
    if "pip install" in str(failure):
        return "install it, and name it under packages in submission.yaml"
    if isinstance(failure, AirHockeyError) and "Read-only file system" in str(failure):
        return "write to tempfile.gettempdir(): nothing else can be written in a sandbox"
    return "mend the code at that line; `hockey evaluate --isolate none --jobs 1` runs it under a debugger"
