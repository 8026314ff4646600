"""What can be watched in a folder or file: recordings by name, loaded when asked for, and what is missing.

Understood are run folders (`hockey evaluate`), whole or half-written, folders of games (`hockey match`,
`hockey tournament`), their films alone, and the official package's `dataset.pkl`.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from airhockey.errors import ConfigurationError
from airhockey.viewing.recording import Recording

DATASET = "dataset.pkl"


@dataclass(frozen=True)
class Entry:
    """One recording that there is.

    Attributes:
        name: What `--episode` calls it.
        load: Reads it.
    """

    name: str
    load: Callable[[], Recording]


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

    def choose(self, names: str | None) -> list[Entry]:
        """The entries of these names, separated by commas; all of them for None."""
        if names is None:
            return list(self.entries)
        return [self.entries[self.position(name.strip())] for name in names.split(",") if name.strip()]


def open_library(path: Path) -> Library:
    """Look into a folder or file.

    Raises:
        ConfigurationError: There is nothing that can be watched; the message says what was looked for.
    """
    from airhockey.viewing.library_games import add_games
    from airhockey.viewing.library_official import add_datasets
    from airhockey.viewing.library_runs import add_run

    if not path.exists():
        raise ConfigurationError(f"there is no {str(path)!r}: give the folder of a run, match or tournament")
    library = Library(path)
    if path.is_file():
        if path.suffix != ".pkl":
            raise ConfigurationError(f"{str(path)!r} is a file, but neither a run folder nor a {DATASET}")
        add_datasets(library, [path])
    else:
        add_run(library)
        add_games(library)
        if not library.entries:
            add_datasets(library, sorted(path.rglob(DATASET)))
    if not library.entries:
        why = f": {'; '.join(library.notes)}" if library.notes else ""
        wanted = f"trajectories of episodes, films of games or a {DATASET}"
        raise ConfigurationError(f"{str(path)!r} holds nothing to watch ({wanted}){why}")
    return library
