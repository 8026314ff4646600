"""One function that builds an agent as asked: in this process, in one of its own, in a sandbox, or behind a TCP port."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from airhockey.agents.submission import is_submission, submission_folder
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.isolation.modes import REMOTE, Mode


def build_agent(
    agent: str,
    env: Any,
    agent_id: int = 1,
    *,
    mode: Mode = "none",
    limits: Limits | None = None,
    patience: float | None = None,
    order: int | None = 3,
    seed: np.random.SeedSequence | None = None,
    env_info: Mapping[str, Any] | None = None,
    **kwargs: Any,
) -> Any:
    """Build an agent.

    Args:
        agent: A name of the registry, the path of a submission, or tcp://HOST:PORT.
        env: The environment that it is to play.
        agent_id: 1 or 2.
        mode: Where it lives.
        limits: What it may use there.
        patience: The longest time for an answer, in [s]; wins over that of `limits`.
        order: The interpolation order of its actions in this environment.
        seed: Seeds the generators of a process of its own; in this process the caller does it.
        env_info: What an agent in this process is given; default: the environment's own.
        kwargs: Handed to the agent.

    Returns:
        Something with `episode_start`, `draw_action`, `stop`, `interpolation_order` and `preprocessors`.

    Raises:
        AgentError: It could not be built where it was to live.
        Exception: In this process: whatever its code raises.
    """
    limits = limits or Limits()
    if patience is not None:
        limits = replace(limits, patience=patience)
    if agent.startswith(REMOTE):
        from airhockey.evaluator.isolation.remote import RemoteAgent

        return RemoteAgent(agent, env.env_info, order, limits.patience)
    if mode == "none":
        from airhockey.evaluator.isolation.build_local import build_with_compatibility

        return build_with_compatibility(agent, env.env_info if env_info is None else dict(env_info), agent_id, **kwargs)
    from airhockey.evaluator.isolation.agent_client import IsolatedAgent
    from airhockey.evaluator.isolation.launch import plain, sandboxed

    folder = submission_folder(Path(agent).expanduser()) if is_submission(agent) else None
    launch = plain(folder) if mode == "process" else sandboxed(folder, limits)
    job = {
        "agent": launch.submission or agent,
        "env": env.name,
        "order": order,
        "edition": env.edition.edition,
        "agent_id": agent_id,
        "kwargs": kwargs,
    }
    return IsolatedAgent(launch, job, limits, seed)
