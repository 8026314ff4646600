"""Whose fault a failure is: an agent's, or the environment's, its disturbances' or this machine's, which no agent answers for.

What nobody who plays has done ends as an `EnvironmentFault`: the run stops and can go on, and nothing is on anybody's record.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.registry import AGENTS
from airhockey.agents.submission import is_submission
from airhockey.envs.disturbances import Disturbances, Mismatch
from airhockey.errors import EnvironmentFault
from airhockey.evaluator.isolation.failures import describe
from airhockey.evaluator.isolation.handle import AgentHandle, LocalAgent
from airhockey.evaluator.isolation.modes import REMOTE, choose

HUGE = 1e6
"""No command of a robot has entries like this. Motors have limits, so that smaller ones never make a simulation fail."""
_MACHINE = (EnvironmentFault, OSError, MemoryError)
"""What is raised on the evaluator's side of an agent that lives elsewhere; its own failures arrive as `AgentError`."""


def absurd(*commands: NDArray[np.float64]) -> bool:
    """Whether one of an agent's latest commands is what a simulation may fail over."""
    return any(bool(np.abs(command).max() > HUGE) for command in commands)


def fault_of(env: Any, failure: BaseException, step: int) -> EnvironmentFault:
    """A simulation failed over commands that no robot would fail over: the profile's fault where it changes the plant.

    Args:
        env: The environment.
        failure: What it raised.
        step: The control step, from 1; 0 in `reset`.
    """
    profile = env.disturbances
    when = f"in step {step} of {env.name}" if step else f"while {env.name} was reset"
    if isinstance(profile, Disturbances) and (profile.torque > 0.0 or profile.mismatch != Mismatch()):
        return EnvironmentFault(
            f"the disturbances {profile.profile!r} make the simulation fail {when}: {describe(failure)}; that is no agent's "
            "fault: lower their torque or mismatch, in a new run"
        )
    return EnvironmentFault(
        f"the environment or this machine failed {when}: {describe(failure)}; that is no agent's fault"
    )


def fault_of_observation(env: Any, step: int) -> EnvironmentFault:
    """An agent failed over an observation that it should never have got."""
    return EnvironmentFault(
        f"the observation of step {step} of {env.name} is not finite, with the disturbances {env.disturbances.profile!r}: "
        "that is no agent's fault"
    )


def fault_of_machine(failure: BaseException, agent: str | AgentHandle, mode: str = "none") -> EnvironmentFault | None:
    """The fault behind an agent's failure where its own code has no part in it; None where it has.

    Args:
        failure: What was raised where it was built or asked.
        agent: Its name or path, or the agent itself.
        mode: Where it lives.
    """
    ours = agent in AGENTS if isinstance(agent, str) else is_ours(agent)
    elsewhere = mode != "none"
    if not (elsewhere and isinstance(failure, _MACHINE)) and not (ours and not elsewhere and _is_machine(failure)):
        return None
    if isinstance(failure, EnvironmentFault):
        return failure
    return EnvironmentFault(f"this machine or installation failed, and no agent: {describe(failure)}")


def is_ours(agent: AgentHandle) -> bool:
    """Whether an agent here is one of airhockey's players, whose code fails over no machine by itself."""
    return isinstance(agent, LocalAgent) and type(agent.agent).__module__.startswith("airhockey.agents.")


def _is_machine(failure: BaseException) -> bool:
    compiler = type(failure).__module__.partition(".")[0] in ("numba", "llvmlite")
    return compiler or isinstance(failure, (*_MACHINE, ImportError))


def foreign_here(agent: str, isolate: str) -> bool:
    """Whether an agent's code, and somebody else's, runs in the evaluator's own process, which it can end.

    Args:
        agent: A name of the registry, the path of a submission, or tcp://HOST:PORT.
        isolate: As asked for; "auto" for nothing.
    """
    if agent.startswith(REMOTE) or not is_submission(agent):
        return False
    return choose(agent, None if isolate == "auto" else isolate).mode == "none"


def worker_lost(agents: Iterable[str], isolate: str, reason: str) -> None:
    """A worker died every time over a job: this machine's fault unless somebody else's code ran in it.

    Raises:
        EnvironmentFault: Only our own code did.
    """
    if not any(foreign_here(agent, isolate) for agent in agents):
        raise machine_ended(reason)


def machine_ended(reason: str) -> EnvironmentFault:
    """The fault of a worker in which no agent's own code ran."""
    return EnvironmentFault(
        f"{reason}, and no agent's code ran in it: this machine ended it, for want of memory perhaps (fewer --jobs)"
    )


def guilty_of(seats: Sequence[Any], before: Sequence[NDArray[np.float64]]) -> list[Any]:
    """The seats whose latest commands a simulation may have failed over.

    Args:
        seats: All.
        before: Each one's command of the step before.
    """
    return [seat for seat, last in zip(seats, before, strict=True) if absurd(seat.action, last)]
