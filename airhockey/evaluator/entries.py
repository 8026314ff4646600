"""The entries of a tournament: as typed, and as a YAML file lists them."""

from collections.abc import Iterable, Mapping
from pathlib import Path

import msgspec

from airhockey.agents import AGENTS
from airhockey.errors import ConfigurationError
from airhockey.evaluator.isolation.modes import REMOTE
from airhockey.evaluator.runs.records import Order
from airhockey.inputs.plain_yaml import read_yaml

NAME_LETTERS = frozenset("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._")


class Entry(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One competitor.

    Attributes:
        name: Letters, digits, "." and "_"; unique in the tournament.
        agent: A name of the registry, or the absolute path of a submission.
        second_agent: Plays in phase 2 instead, if given.
        interpolation_order: See `records.Order`.
        python: Another interpreter for a submission's process.
        settings: Of our own players' controller.
    """

    name: str
    agent: str
    second_agent: str | None = None
    interpolation_order: Order = "agent"
    python: str | None = None
    settings: tuple[str, ...] = ()

    def agent_in(self, phase: int) -> str:
        """Who plays for this entry in a phase, 1 or 2."""
        return self.second_agent if phase == 2 and self.second_agent is not None else self.agent


class EntriesFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A YAML file of entries, where it is not simply a list of them."""

    entries: list[Entry]


def entry_of(text: str) -> Entry:
    """An entry as typed: "AGENT", or "NAME=AGENT"."""
    name, equals, agent = text.partition("=")
    if not equals or not set(name) <= NAME_LETTERS:  # or the sign is part of a path
        name, agent = "", text
    return Entry(name=name or _default_name(agent), agent=agent)


def with_replacements(entries: Iterable[Entry], replacements: Mapping[str, str]) -> tuple[Entry, ...]:
    """The entries, those named in `replacements` with another agent for phase 2."""
    entries = tuple(entries)
    for name in replacements:
        if name not in {entry.name for entry in entries}:
            raise ConfigurationError(
                f"cannot replace {name!r}: the entries are {', '.join(entry.name for entry in entries)}"
            )
    return tuple(
        msgspec.structs.replace(entry, second_agent=replacements.get(entry.name, entry.second_agent))
        for entry in entries
    )


def read_entries(path: Path) -> list[Entry]:
    """Entries from a YAML file: a list, or a mapping with the key `entries`; paths are relative to the file."""
    try:
        content = read_yaml(path)
        listed = content if isinstance(content, dict) else {"entries": content}
        entries = msgspec.convert(listed, EntriesFile).entries
    except msgspec.ValidationError as error:
        raise ConfigurationError(
            f"the entries in {str(path)!r} are not valid: {' '.join(str(error).split())}"
        ) from error

    def located(agent: str) -> str:
        is_path = agent not in AGENTS and not agent.startswith(REMOTE)
        return str(path.parent / Path(agent).expanduser()) if is_path else agent

    return [
        msgspec.structs.replace(
            entry, agent=located(entry.agent), second_agent=entry.second_agent and located(entry.second_agent)
        )
        for entry in entries
    ]


def _default_name(agent: str) -> str:
    return "".join(letter if letter in NAME_LETTERS else "_" for letter in Path(agent).stem)
