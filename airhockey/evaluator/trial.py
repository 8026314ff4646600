"""A submission tried out: a few steps of one task, apart from everything, and what went wrong, with its remedy."""

import functools
import time
from collections.abc import Iterator

import msgspec
import numpy as np

from airhockey import envs
from airhockey.envs.editions import DEFAULT
from airhockey.errors import ActionError
from airhockey.evaluator.isolation.failures import AgentDied, AgentTimeout, describe
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.pacing import PAUSE
from airhockey.evaluator.play.build_seats import Entrant, build_seats
from airhockey.evaluator.play.game import TIME_LIMIT
from airhockey.evaluator.play.rollout import Rollout
from airhockey.evaluator.play.seat import Care, Seat

GAME = "tournament"


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


def try_out(mine: Entrant, task: str, steps: int, side: int = 1, edition: str = DEFAULT) -> Trial | Problem:
    """Play a few steps of one task, alone or against somebody who stands still."""
    limits = mine.limits
    entrants = [mine] if task != GAME else [mine, Entrant("hold")] if side == 1 else [Entrant("hold"), mine]
    began = time.perf_counter()
    env, seats = build_seats(functools.partial(envs.make, task, edition=edition), entrants, Care())
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


def slow(trial: Trial) -> Iterator[Problem]:
    """A problem where its commands take longer than a control step."""
    longest = max(trial.median, trial.longest_cpu)
    if longest > TIME_LIMIT:
        yield Problem(
            trial.env,
            f"draw_action took {longest * 1e3:.1f} ms; a control step has {TIME_LIMIT * 1e3:.0f} ms",
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
    if "git submodule" in text:
        return "fetch what belongs to the checkout: git submodule update --init --recursive"
    if any(word in text for word in ("imports '", "has no such file", "defines no function")):
        return "mend the import, and see that the file is part of the submission"
    if any(word in text for word in ("Read-only file system", "PermissionError")):
        return (
            "write to tempfile.gettempdir(): nothing else can be written in a sandbox; --isolate process lets it write "
            "wherever you can"
        )
    return "mend the code at that line; `hockey evaluate --isolate none --jobs 1` runs it under a debugger"
