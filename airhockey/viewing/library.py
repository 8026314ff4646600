"""What can be watched in a folder or file.

Understood are run folders (`hockey evaluate`), whole or half-written, folders of games (`hockey match`,
`hockey tournament`), their films alone, and the official package's `dataset.pkl`.
"""

from pathlib import Path

from airhockey.errors import ConfigurationError
from airhockey.evaluator.runs.reader import Run, look_into
from airhockey.viewing.entries import Library
from airhockey.viewing.library_games import add_games
from airhockey.viewing.library_official import DATASET, add_datasets
from airhockey.viewing.library_runs import add_run


def open_library(path: Path) -> Library:
    """Look into a folder or file.

    Raises:
        ConfigurationError: There is nothing that can be watched; the message says what was looked for.
    """
    if not path.exists():
        raise ConfigurationError(f"there is no {str(path)!r}: give the folder of a run, match or tournament")
    library = Library(path)
    if path.is_file():
        if path.suffix != ".pkl":
            raise ConfigurationError(f"{str(path)!r} is a file, but neither a run folder nor a {DATASET}")
        add_datasets(library, [path])
    else:
        found = look_into(path)
        if isinstance(found, Run):
            add_run(library, found)
        elif found is not None:
            add_games(library, found)
        if not library.entries:
            add_datasets(library, sorted(path.rglob(DATASET)))
    if not library.entries:
        why = f": {'; '.join(library.notes)}" if library.notes else ""
        wanted = f"trajectories of episodes, films of games or a {DATASET}"
        raise ConfigurationError(f"{str(path)!r} holds nothing to watch ({wanted}){why}")
    return library
