"""Is a submission fit to be handed in? Load it apart from everything, play a little, and say what to mend, and how."""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from airhockey import envs
from airhockey.agents.hold import standing_still
from airhockey.agents.packaging.metadata import METADATA, Metadata, interpolation_order, read_metadata
from airhockey.agents.packaging.packing import contents
from airhockey.agents.submission import CONFIG, submission_config, submission_folder, wanted_order
from airhockey.errors import ActionError, AirHockeyError, ConfigurationError
from airhockey.evaluator.isolation.build import build_agent
from airhockey.evaluator.isolation.failures import AgentDied, AgentTimeout
from airhockey.evaluator.isolation.handle import AgentHandle
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.isolation.modes import Mode
from airhockey.evaluator.play.episode import agent_failures, describe

STEP_LIMIT = 0.02
"""Beyond this the previous command is held in a game, and penalty points are due, in [s]."""


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
    order = wanted_order(Path(agent))
    game = task == "tournament"
    env = envs.make(task, (order, 3) if game else order)
    step, player, began, longest_cpu = 0, None, time.perf_counter(), 0.0
    try:
        player = build_agent(agent, env, mode=mode, limits=limits, order=order)
        start, times = time.perf_counter() - began, list[float]()
        clock = player.clock("cpu") if isinstance(player, AgentHandle) else time.thread_time
        player.episode_start()
        observation = env.reset(seed=0)
        half = observation.size // 2
        for _ in range(steps):
            step += 1
            began, used = time.perf_counter(), clock()
            action = player.draw_action(observation[:half] if game else observation)
            times.append(time.perf_counter() - began)
            longest_cpu = max(longest_cpu, clock() - used if step > 1 else 0.0)
            other = standing_still(np.array(env.simulation.robot.start), 3)
            observation, _, over, _ = env.step((action, other) if game else action)
            if over:
                observation = env.reset()
        player.stop()
    except agent_failures() as failure:
        printed = getattr(player, "printed", "")
        where = f"{task}, step {step}" if step else f"{task}, loading"
        return Problem(where, describe(failure), _remedy(failure, printed, limits))
    finally:
        if isinstance(player, AgentHandle):
            player.close()
    rest = times[1:] or times
    return Trial(task, len(times), start, float(np.median(rest)), max(rest), times[0], longest_cpu)


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
    if slow > STEP_LIMIT:
        yield Problem(
            trial.env,
            f"draw_action took {slow * 1e3:.1f} ms; a control step has {STEP_LIMIT * 1e3:.0f} ms",
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
