"""What an attack ended in, and the table of all."""

from collections.abc import Iterable
from dataclasses import dataclass

HELD, ESCAPE, CHANGED, TRACEBACK, HANG, LEFTOVER, SKIPPED = (
    "held", "escape", "changed", "traceback", "hang", "leftover", "skipped",
)  # fmt: skip
BAD = (ESCAPE, CHANGED, TRACEBACK, HANG, LEFTOVER)


@dataclass(frozen=True)
class Verdict:
    """How one attack ended.

    Attributes:
        kind: The table's row.
        name: Of the attack.
        outcome: One of the words above.
        detail: What was seen, in one line.
    """

    kind: str
    name: str
    outcome: str
    detail: str = ""


Counts = dict[str, dict[str, int]]
"""Row of the table -> outcome -> how many attacks ended in it."""


def count(verdicts: Iterable[Verdict]) -> Counts:
    """How many attacks of each row ended how."""
    counts: Counts = {}
    for verdict in verdicts:
        row = counts.setdefault(verdict.kind, dict.fromkeys((HELD, *BAD, SKIPPED), 0))
        row[verdict.outcome] += 1
    return counts


def table(parts: Iterable[Counts]) -> str:
    """One row for each kind, one column for each outcome, as Markdown."""
    heads = (
        "kind",
        "tried",
        "escapes",
        "lost or changed results",
        "tracebacks",
        "hangs",
        "leftovers",
        "not possible here",
    )
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    total = [0] * (len(heads) - 1)
    for kind, row in (pair for counts in parts for pair in counts.items()):
        numbers = [sum(row.values()) - row[SKIPPED], *(row[outcome] for outcome in BAD), row[SKIPPED]]
        total = [one + other for one, other in zip(total, numbers, strict=True)]
        lines.append("| " + " | ".join((kind, *map(str, numbers))) + " |")
    lines.append("| " + " | ".join(("**all**", *map(str, total))) + " |")
    return "\n".join(lines)
