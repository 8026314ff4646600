"""Is a submission fit to be handed in? Load it apart from everything, play a little, and say what to mend, and how."""

import functools
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from airhockey import envs
from airhockey.agents.packaging.checkout import PACKAGE, find_checkout
from airhockey.agents.packaging.metadata import METADATA, Metadata, interpolation_order, read_metadata
from airhockey.agents.packaging.packing import contents
from airhockey.agents.registry import EVERY_ENVIRONMENT
from airhockey.agents.submission import CONFIG, submission_config
from airhockey.compat.entries import notes
from airhockey.errors import ActionError, AirHockeyError, ConfigurationError, unknown
from airhockey.evaluator.isolation.failures import AgentDied, AgentTimeout, describe
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.isolation.modes import Mode
from airhockey.evaluator.pacing import BUSY, PAUSE
from airhockey.evaluator.play.build_seats import Entrant, build_seats
from airhockey.evaluator.play.game import TIME_LIMIT
from airhockey.evaluator.play.rollout import Rollout
from airhockey.evaluator.play.seat import Care, Seat

GAME = "tournament"
_OFFICIAL_NAMES = {
    "hit": "7dof-hit",
    "hit_single": "7dof-hit",
    "defend": "7dof-defend",
    "prepare": "7dof-prepare",
    "tournament_server": GAME,
}
"""Names of environments in configurations of 2025, and of the official servers."""


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
        thinking: CPU time between its answers, in threads and children, in [s].
    """

    env: str
    steps: int
    start: float
    median: float
    longest: float
    first: float
    longest_cpu: float
    thinking: float = 0.0


class Verdict(msgspec.Struct, frozen=True):
    """What validation found.

    Attributes:
        left_out: File -> why `hockey package` leaves it out.
        notes: How the submission is played, where that is not obvious.
        conclusion: Plays, or does not because of what; whose cause that is, and what to do. One line.
    """

    name: str
    problems: tuple[Problem, ...]
    trials: tuple[Trial, ...]
    left_out: dict[str, str]
    notes: tuple[str, ...] = ()
    conclusion: str = ""


def validate(path: Path, mode: Mode, limits: Limits, steps: int = 50, python: str | None = None) -> Verdict:
    """Look at a submission and let it play.

    Args:
        path: Folder or archive: a checkout, the folder of its agent, or one of ours.
        mode: Where its code runs.
        limits: What it may use, and how long anybody waits.
        steps: Control steps of each task.
        python: Another interpreter for its process.
    """
    name = path.name if path.is_file() else path.resolve().name
    try:
        checkout = find_checkout(path)
    except ConfigurationError as error:
        remedy = "`hockey new DIR` makes a folder as it should be, `hockey package DIR` an archive"
        problem = Problem(name, str(error), remedy)
        return Verdict(name, (problem,), (), {}, conclusion=concluded(name, [], [problem]))
    metadata, config, problems = _paper(checkout.package)
    name = metadata.name if metadata is not None else checkout.root.name if name == PACKAGE else name
    left_out, trials = dict[str, str](), list[Trial]()
    if metadata is not None and path.is_dir():
        try:
            left_out = contents(path)[1]
        except ConfigurationError as error:
            remedy = "see the names and sizes above; `hockey package` needs this"
            problems.append(Problem(name, str(error), remedy))
    told = list(notes(path))
    if not any(problem.where == CONFIG for problem in problems):
        tasks, unknown_tasks = _tasks(metadata, config)
        problems += unknown_tasks
        if metadata is None:
            where = f"env in {CONFIG}" if "env" in config else f"the usual ones ({CONFIG} names none)"
            told.append(
                f"the layout is the official one; the tasks are {where}; `hockey package` would want a {METADATA}"
            )
        sides = [(task, 1) for task in tasks] + [(task, 2) for task in tasks if task == GAME]
        for task, side in sides:
            entrant = Entrant(str(path.resolve()), isolate=mode, limits=limits, python=python)
            outcome = try_out(entrant, task, steps, side)
            if isinstance(outcome, Trial):
                trials.append(outcome)
                problems += _slow(outcome)
            else:
                problems.append(outcome)
    if any(trial.thinking > BUSY for trial in trials):
        told.append(
            "it thinks between its steps, in threads or processes: evaluations pace them as on the robot (--real-time)"
        )
    conclusion = concluded(name, trials, problems)
    return Verdict(name, tuple(problems), tuple(trials), left_out, tuple(told), conclusion)


def concluded(name: str, trials: list[Trial], problems: list[Problem]) -> str:
    """One line: plays, or does not play because …, whose cause that is, what to do."""
    played = ", ".join(dict.fromkeys(trial.env for trial in trials))
    if not problems:
        return f"{name}: plays {played}: fit to be handed in"
    first, more = problems[0], f"; and {len(problems) - 1} more problem(s)" if len(problems) > 1 else ""
    what = f"{first.what} (in {first.where}; {_cause(first)}); what to do: {first.remedy}{more}"
    return f"{name}: plays {played}, but {what}" if played else f"{name}: does not play, because {what}"


def _cause(problem: Problem) -> str:
    """Whose cause a problem is."""
    if "is not installed" in problem.what:
        return "this installation's cause"
    if any(
        word in problem.what
        for word in ("written for another version", "0-dimensional", "array element with a sequence")
    ):
        return "the libraries' cause: they are not those of its time"
    if "No space left" in problem.what or "bubblewrap" in problem.what:
        return "this machine's cause"
    return "the entry's cause"


def try_out(mine: Entrant, task: str, steps: int, side: int = 1) -> Trial | Problem:
    """Play a few steps of one task, alone or against somebody who stands still."""
    limits = mine.limits
    entrants = [mine] if task != GAME else [mine, Entrant("hold")] if side == 1 else [Entrant("hold"), mine]
    began = time.perf_counter()
    env, seats = build_seats(functools.partial(envs.make, task), entrants, Care())
    start, seat, rollout = time.perf_counter() - began, seats[side - 1], Rollout(env, seats, seed=0)
    where = task if side == 1 else f"{task} (away)"
    if seat.agent is None or seat.error is not None:
        return _problem(where, rollout, seat, limits)
    watched = _Watched(seat)
    rollout.begin()
    times, thinking = list[float](), 0.0
    while len(times) < steps and rollout.step():
        times.append(seat.seconds)
        thinking += watched.pause()
        if rollout.over:
            rollout.begin()
    seat.stop()
    if seat.error is not None:
        return _problem(where, rollout, seat, limits)
    rest = times[1:] or times
    return Trial(where, len(times), start, float(np.median(rest)), max(rest), times[0], watched.longest_cpu, thinking)


class _Watched:
    """A seat whose clock also notes the CPU time of each action."""

    def __init__(self, seat: Seat) -> None:
        assert seat.agent is not None
        self._agent, self._times = seat.agent, list[float]()
        wall, cpu = seat.clock, seat.agent.clock("cpu")

        def both() -> float:
            self._times.append(cpu())
            return wall()

        seat.clock = both

    @property
    def longest_cpu(self) -> float:
        """CPU time of the action that used most of it, in [s], the first one apart."""
        pairs = zip(self._times[2::2], self._times[3::2], strict=False)
        return max((after - before for before, after in pairs), default=0.0)

    def pause(self) -> float:
        """Wait a little; gives the CPU time that the agent used meanwhile, in [s], where it can be told from the evaluator."""
        return self._agent.thinks_for(PAUSE)


def _problem(task: str, rollout: Rollout, seat: Seat, limits: Limits) -> Problem:
    """What the agent did wrong."""
    assert seat.error is not None
    printed = "" if seat.agent is None else seat.agent.printed
    where = f"{task}, step {rollout.steps}" if rollout.steps else f"{task}, loading"
    return Problem(where, describe(seat.error), _remedy(seat.error, printed, limits))


def _tasks(metadata: Metadata | None, config: dict[str, Any]) -> tuple[list[str], list[Problem]]:
    """What a submission plays: what its metadata or its configuration names, else everything of the iiwa."""
    if metadata is not None:
        return list(metadata.tasks), []
    named = config.get("env", ["7dof-hit", "7dof-defend", "7dof-prepare", GAME])
    tasks, problems = list[str](), list[Problem]()
    for name in named if isinstance(named, list) else [named]:
        task = _OFFICIAL_NAMES.get(str(name), str(name))
        if task in EVERY_ENVIRONMENT:
            tasks.append(task)
        else:
            problems.append(
                Problem(f"env of {CONFIG}", str(unknown("environment", task, EVERY_ENVIRONMENT)), "name one of these")
            )
    return list(dict.fromkeys(tasks)), problems


def _paper(folder: Path) -> tuple[Metadata | None, dict[str, Any], list[Problem]]:
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
        problems += _contradictions(metadata, config) if metadata is not None else ()
    return metadata, config, problems


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
    text = str(failure)
    if "pip install" in text:
        return "install it, and name it under packages in submission.yaml"
    if "only 0-dimensional arrays can be converted" in text or "setting an array element with a sequence" in text:
        return (
            "NumPy 2.4 takes no array of one entry for a number: write x.item(), or use an older NumPy (--python PATH)"
        )
    if "CUDA" in text or "NVIDIA driver" in text:
        return 'there is no GPU in an evaluation: choose the device by torch.cuda.is_available(), and "cpu" where there is none'
    if text.startswith("NotImplementedError"):
        return "build_agent refuses this environment, or is the template as it was: name in env what the agent plays"
    if "--python PATH" in text:
        return "import what there is today, or evaluate it with an interpreter that has the old one (--python PATH)"
    if any(word in text for word in ("imports '", "has no such file", "defines no function")):
        return "mend the import, and see that the file is part of the submission"
    if isinstance(failure, AirHockeyError) and "Read-only file system" in str(failure):
        return "write to tempfile.gettempdir(): nothing else can be written in a sandbox"
    return "mend the code at that line; `hockey evaluate --isolate none --jobs 1` runs it under a debugger"
