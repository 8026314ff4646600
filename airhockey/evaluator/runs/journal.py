"""The journal: a line of JSON per finished piece of work, on the disk before the next one is taken.

A kill may cut the last line short; it is left out when the journal is read, and goes away when the run is taken up again.
"""

import os
from collections.abc import Hashable, Iterable
from pathlib import Path
from typing import Generic, NamedTuple, Protocol, TypeVar

import msgspec

from airhockey.evaluator.runs.disk import JSON, replace_file

NAME = "journal.jsonl"


class Keyed(Protocol):
    """A record of a finished piece of work."""

    @property
    def key(self) -> Hashable:
        """Says which of the run's pieces of work it is."""


Record = TypeVar("Record", bound=Keyed)


class Journal(NamedTuple, Generic[Record]):
    """What a journal says.

    Attributes:
        records: In the order in which the work was finished; of two about the same piece the later one.
        unreadable: Number of lines that are no records.
    """

    records: list[Record]
    unreadable: int


def read_journal(path: Path, record_type: type[Record]) -> Journal[Record]:
    """Read the journal in a folder; one that does not exist holds nothing.

    Args:
        path: The folder.
        record_type: What its lines are.

    Raises:
        OSError: It cannot be read.
    """
    journal = path / NAME
    records: dict[Hashable, Record] = {}
    unreadable = 0
    for line in journal.read_bytes().splitlines() if journal.exists() else []:
        try:
            record = msgspec.json.decode(line, type=record_type)
        except (msgspec.MsgspecError, UnicodeDecodeError):
            unreadable += 1
        else:
            records[record.key] = record
    return Journal(list(records.values()), unreadable)


def append(path: Path, records: Iterable[Keyed]) -> None:
    """Add lines; they are on the disk when this returns."""
    with (path / NAME).open("ab") as journal:
        journal.write(JSON.encode_lines(list(records)))
        journal.flush()
        os.fsync(journal.fileno())


def mend(path: Path, records: Iterable[Keyed]) -> None:
    """Make the journal say this and nothing else, where it does not."""
    journal, whole = path / NAME, JSON.encode_lines(list(records))
    if not journal.exists() or journal.read_bytes() != whole:
        replace_file(journal, whole)
