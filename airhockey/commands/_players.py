"""Options that are for one player or for all: `--python home:PATH`, `--set away:control.solver=osqp`."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from airhockey.agents import AGENTS
from airhockey.agents.submission import is_submission
from airhockey.commands._session import python_of
from airhockey.errors import ConfigurationError
from airhockey.evaluator.isolation.modes import REMOTE


def pythons_of(given: Mapping[str, Any], agents: Mapping[str, str]) -> dict[str, str | None]:
    """Player -> the interpreter of its process, None for the evaluator's own.

    Args:
        given: The options.
        agents: Player -> agent, as a name of the registry, a full path or an address.

    Raises:
        ConfigurationError: There is no submission to use it, or it is no usable interpreter.
    """
    texts = _by_player("--python", given["python"], agents, _has_a_process)
    return {player: python_of(paths[-1]) if paths else None for player, paths in texts.items()}


def settings_of(given: Mapping[str, Any], agents: Mapping[str, str]) -> dict[str, tuple[str, ...]]:
    """Player -> settings of its controller; raises `ConfigurationError` where no player of ours plays."""
    texts = _by_player("--set", given["settings"], agents, AGENTS.__contains__)
    return {player: tuple(values) for player, values in texts.items()}


def _by_player(
    option: str, texts: Sequence[str], agents: Mapping[str, str], fits: Callable[[str], bool]
) -> dict[str, list[str]]:
    """Player -> what was typed for it, that for everybody first; for everybody means: for those whom it fits."""
    fitting = [player for player, agent in agents.items() if fits(agent)]
    found: dict[str, list[str]] = {player: [] for player in agents}
    named = [text for text in texts if text.partition(":")[0] in agents and ":" in text]
    for text in (text for text in texts if text not in named):
        if not fitting:
            who = (
                f"fits nobody who plays: {', '.join(agents.values())}"
                if agents
                else "is a player's: name the players, too"
            )
            raise ConfigurationError(f"{option} {text!r} {who}")
        for player in fitting:
            found[player].append(text)
    for text in named:
        player, _, value = text.partition(":")
        found[player].append(value)
    return found


def _has_a_process(agent: str) -> bool:
    return not agent.startswith(REMOTE) and is_submission(agent)
