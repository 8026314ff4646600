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


Outcomes = dict[str, dict[str, str]]
"""Row of the table -> name of an attack -> what it ended in."""


def outcomes(verdicts: Iterable[Verdict], before: Outcomes) -> Outcomes:
    """What every attack ended in, with those that were tried before and not again."""
    found = {kind: dict(row) for kind, row in before.items()}
    for verdict in verdicts:
        found.setdefault(verdict.kind, {})[verdict.name] = verdict.outcome
    return found


def table(parts: Iterable[Outcomes]) -> str:
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
    for kind, row in (pair for found in parts for pair in found.items()):
        ends = list(row.values())
        numbers = [len(ends) - ends.count(SKIPPED), *map(ends.count, (*BAD, SKIPPED))]
        total = [one + other for one, other in zip(total, numbers, strict=True)]
        lines.append("| " + " | ".join((kind, *map(str, numbers))) + " |")
    lines.append("| " + " | ".join(("**all**", *map(str, total))) + " |")
    return "\n".join(lines)
