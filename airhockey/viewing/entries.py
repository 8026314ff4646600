"""Recordings by name, loaded when asked for, and what is missing among them."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from airhockey.errors import ConfigurationError
from airhockey.viewing.recording import Recording


@dataclass(frozen=True)
class Entry:
    """One recording that there is.

    Attributes:
        name: What `--episode` calls it.
        load: Reads it.
        failed: Whether it is of an episode that went wrong.
    """

    name: str
    load: Callable[[], Recording]
    failed: bool = False


@dataclass
class Library:
    """The recordings of one place.

    Attributes:
        path: The place.
        entries: What there is, in order.
        notes: What is missing or broken, a line each.
    """

    path: Path
    entries: list[Entry] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def position(self, name: str) -> int:
        """Where the entry of this name stands; "3" also means the only one whose name ends with "/3".

        Raises:
            ConfigurationError: There is none, or more than one.
        """
        names = [entry.name for entry in self.entries]
        if name in names:
            return names.index(name)
        ends = [k for k, other in enumerate(names) if other.endswith(f"/{name}")]
        if len(ends) == 1:
            return ends[0]
        if ends:
            several = ", ".join(names[k] for k in ends)
            raise ConfigurationError(f"{name!r} is the name of several episodes in {str(self.path)!r}: {several}")
        shown = ", ".join(names[:8]) + (f", … {names[-1]} ({len(names)} in all)" if len(names) > 8 else "")
        raise ConfigurationError(f"there is no episode {name!r} in {str(self.path)!r}; there are {shown}")

    def choose(self, names: str | None, failed: bool = False) -> list[Entry]:
        """The entries of these names, separated by commas; all of them for None.

        Args:
            names: Or None.
            failed: Only those of episodes that went wrong.

        Raises:
            ConfigurationError: There is none of a name, or none that went wrong.
        """
        chosen = self._named(names)
        if not failed:
            return chosen
        wrong = [entry for entry in chosen if entry.failed]
        if not wrong:
            raise ConfigurationError(f"no episode went wrong in {str(self.path)!r} (of {len(chosen)})")
        return wrong

    def _named(self, names: str | None) -> list[Entry]:
        if names is None:
            return list(self.entries)
        return [self.entries[self.position(name.strip())] for name in names.split(",") if name.strip()]
