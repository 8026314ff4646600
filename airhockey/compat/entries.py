"""Building a submission's agent: the challenge's package, its own copy of it, and bridges to the libraries of today."""

from pathlib import Path
from typing import Any

from airhockey.agents.packaging.checkout import find_checkout
from airhockey.agents.submission import build_submission
from airhockey.compat import bridges
from airhockey.compat.finder import install
from airhockey.compat.own_copy import look_at
from airhockey.compat.rl_info import settle


def build_entry(path: Path, env_info: dict[str, Any], agent_id: int = 1, **kwargs: Any) -> Any:
    """Build the agent of a submission; see `airhockey.agents.submission.build_submission`."""
    install(look_at(find_checkout(path).own_challenge))
    bridges.install()
    return build_submission(path, env_info, agent_id, prepare=lambda: settle(env_info), **kwargs)


def notes(path: Path) -> list[str]:
    """What a verdict should say about how a submission is played."""
    own = look_at(find_checkout(path).own_challenge)
    told = own.told() if own is not None else None
    return [told] if told is not None else []
