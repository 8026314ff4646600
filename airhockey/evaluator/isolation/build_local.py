"""Where an agent of a child process is made: from an environment's name to the agent and its `env_info`."""

from pathlib import Path
from typing import Any


def build_here(job: dict[str, Any]) -> tuple[Any, int]:
    """Build an agent in this process.

    Args:
        job: `agent`, a name or a path; `env`, `orders`, `edition`: of the environment; `agent_id`; `kwargs`.

    Returns:
        The agent, and the number of entries of its observations.
    """
    from airhockey import envs

    order = job["order"]
    game = job["env"] == "tournament"
    env = envs.make(job["env"], (order, order) if game else order, edition=job["edition"])
    env_info = env.env_info
    size = env_info["rl_info"].observation_space.shape[0]
    return build_with_compatibility(job["agent"], env_info, job["agent_id"], **job["kwargs"]), size


def build_with_compatibility(agent: str, env_info: dict[str, Any], agent_id: int, **kwargs: Any) -> Any:
    """Build an agent; a submission finds the package `air_hockey_challenge` when it imports it."""
    from airhockey.agents import build_agent
    from airhockey.agents.submission import is_submission

    if is_submission(agent):
        from airhockey.compat import build_entry

        return build_entry(Path(agent).expanduser(), env_info, agent_id, **kwargs)
    return build_agent(agent, env_info, agent_id=agent_id, **kwargs)
