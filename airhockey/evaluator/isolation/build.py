"""One function that builds an agent as asked: in this process, in one of its own, in a sandbox, or behind a TCP port."""

import copy
from pathlib import Path
from typing import Any

import numpy as np

from airhockey.agents.packaging.checkout import find_checkout
from airhockey.agents.submission import is_submission
from airhockey.evaluator.isolation.handle import AgentHandle
from airhockey.evaluator.isolation.interpreters import foreign_job, interpreter
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.isolation.modes import REMOTE, Mode, check_python


def build_agent(
    agent: str,
    env: Any,
    agent_id: int = 1,
    *,
    mode: Mode = "none",
    limits: Limits | None = None,
    seed: np.random.SeedSequence | None = None,
    python: str | None = None,
    **kwargs: Any,
) -> AgentHandle:
    """Build an agent for one robot of an environment, whose interpolation order there is the order of its actions.

    Args:
        agent: A name of the registry, the path of a submission, or tcp://HOST:PORT.
        env: The environment that it is to play; one in this process is given a copy of its `env_info`.
        agent_id: 1 or 2.
        mode: Where it lives.
        limits: What it may use there, and how long anybody waits.
        seed: Seeds the generators of a process of its own; in this process the caller does it.
        python: Another interpreter for a submission's process.
        kwargs: Handed to the agent.

    Raises:
        AgentError: It could not be built where it was to live.
        Exception: In this process: whatever its code raises.
    """
    limits = limits or Limits()
    order = env.formats[min(agent_id, env.n_players) - 1].order
    if agent.startswith(REMOTE):
        from airhockey.evaluator.isolation.remote import RemoteAgent

        return RemoteAgent(agent, env.env_info, order, limits.patience)
    check_python(agent, mode, python)
    own = None if python is None else interpreter(python)
    if mode == "none":
        from airhockey.evaluator.isolation.build_local import build_local

        return build_local(agent, copy.deepcopy(env.env_info), agent_id, **kwargs)
    from airhockey.evaluator.isolation.agent_client import IsolatedAgent
    from airhockey.evaluator.isolation.launch import plain, sandboxed

    checkout = find_checkout(Path(agent).expanduser()) if is_submission(agent) else None
    launch = plain(checkout, own) if mode == "process" else sandboxed(checkout, limits, own)
    if own is not None and checkout is not None:
        inside = str(checkout.root) if mode == "process" else str(launch.submission)
        job = foreign_job(checkout, inside, env, agent_id, kwargs) | {"agent": agent}
    else:
        job = {
            "agent": launch.submission or agent,
            "env": env.name,
            "order": order,
            "edition": env.edition.edition,
            "agent_id": agent_id,
            "kwargs": kwargs,
        }
    return IsolatedAgent(launch, job, limits, seed, agent)
