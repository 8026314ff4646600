"""Agents that think beside the steps, in threads or children: whether one does, and the pace that it needs.

Steps here take a fraction of the 20 ms that they stand for, so that a plan which is made meanwhile never comes in time. Such an
agent is played at the pace of the real robot, unless the user says otherwise; the run's options keep the pace.
"""

import functools
import re
from pathlib import Path

from airhockey import envs
from airhockey.agents.packaging.checkout import find_checkout
from airhockey.agents.submission import is_submission
from airhockey.envs.editions import DEFAULT
from airhockey.errors import ConfigurationError
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.isolation.modes import REMOTE, choose
from airhockey.evaluator.play.build_seats import Entrant, build_seats
from airhockey.evaluator.play.rollout import Rollout
from airhockey.evaluator.play.seat import Care

PAUSE = 0.01
"""After each step of a trial, in [s]: time to think in."""
BUSY = 0.02
"""CPU time in all pauses together beyond which an agent thinks beside its steps, in [s]; an idle one uses a tenth of it."""
_STEPS = 60
_MAX_SOURCE = 1 << 20
_CONCURRENT = re.compile(
    r"^\s*(?:from|import)\s+(?:threading|_thread|multiprocessing|concurrent|subprocess|asyncio|joblib|ray|torch\.multiprocessing)\b",
    re.MULTILINE,
)


def pace_for(
    agent: str,
    environment: str,
    isolate: str | None = None,
    patience: float = Limits.patience,
    python: str | None = None,
    edition: str = DEFAULT,
) -> float:
    """The pace that an agent needs: 1 for one that thinks beside its steps, 0 (as fast as possible) for everybody else.

    Only a submission whose files import what starts threads or processes is tried out for that.

    Args:
        agent: A name of the registry, the path of a submission, or tcp://HOST:PORT.
        environment: What it is tried out in.
        isolate: Where it lives during the trial; never in this process.
        patience: Longest time for an answer, in [s].
        python: Another interpreter for its process.
        edition: Of the environment.
    """
    if agent.startswith(REMOTE) or not is_submission(agent) or not starts_anything(Path(agent)):
        return 0.0
    mode = choose(agent, isolate).mode
    mode = "process" if mode == "none" else mode
    entrants = [Entrant(agent, isolate=mode, limits=Limits(patience=patience), python=python)]
    if environment == "tournament":
        entrants.append(Entrant("hold"))
    env, seats = build_seats(functools.partial(envs.make, environment, edition=edition), entrants, Care())
    rollout = Rollout(env, seats, seed=0)
    try:
        return 1.0 if not rollout.failed and thinking_time(rollout, _STEPS) > BUSY else 0.0
    finally:
        for seat in seats:
            seat.close()


def thinking_time(rollout: Rollout, steps: int) -> float:
    """CPU time that the first seat's agent, its threads and children use between its answers, in [s].

    Args:
        rollout: Not begun. Its agent lives in another process, or it cannot be told from the evaluator: 0.
        steps: How many to play; each is followed by a pause.
    """
    agent, used = rollout.seats[0].agent, 0.0
    if agent is None:
        return used
    rollout.begin()
    for _ in range(steps):
        if not rollout.step():
            break
        used += agent.thinks_for(PAUSE)
        if rollout.over:
            rollout.begin()
    return used


def starts_anything(path: Path) -> bool:
    """Whether a submission's own files import what starts threads or processes."""
    try:
        checkout = find_checkout(path.expanduser())
    except ConfigurationError:
        return False
    own = checkout.own_challenge
    for file in checkout.root.rglob("*.py"):
        if own is not None and file.is_relative_to(own):
            continue
        if any(part.startswith(".") or part == "site-packages" for part in file.relative_to(checkout.root).parts):
            continue
        try:
            if file.stat().st_size <= _MAX_SOURCE and _CONCURRENT.search(file.read_text(errors="replace")):
                return True
        except OSError:
            continue
    return False
