"""How an agent is made in the process that it lives in, the evaluator's or its own."""

from pathlib import Path
from typing import Any

from airhockey.evaluator.isolation.handle import LocalAgent


def build_from_names(job: dict[str, Any]) -> tuple[LocalAgent, int]:
    """Build an agent from what can be written down about it, its `env_info` included.

    Args:
        job: `agent`, a name or a path; `env`, `order`, `edition`: of the environment; `agent_id`; `kwargs`.

    Returns:
        The agent, and the number of entries of its observations.
    """
    from airhockey import envs

    order = job["order"]
    game = job["env"] == "tournament"
    env = envs.make(job["env"], (order, order) if game else order, edition=job["edition"])
    size = env.env_info["rl_info"].observation_space.shape[0]
    return build_local(job["agent"], env.env_info, job["agent_id"], **job["kwargs"]), size


def build_local(agent: str, env_info: dict[str, Any], agent_id: int = 1, **kwargs: Any) -> LocalAgent:
    """Build an agent; a submission finds the package `air_hockey_challenge` when it imports it."""
    from airhockey.agents import build_agent
    from airhockey.agents.submission import is_submission

    if is_submission(agent):
        from airhockey.agents.packaging.checkout import find_checkout
        from airhockey.compat import build_entry

        path = Path(agent).expanduser()
        root = find_checkout(path).root
        home = None if root == Path.cwd() else str(root)  # a process of its own is there already
        return LocalAgent(build_entry(path, env_info, agent_id, **kwargs), home)
    return LocalAgent(build_agent(agent, env_info, agent_id=agent_id, **kwargs))
