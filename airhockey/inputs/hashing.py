"""Inputs known by their content: SHA-256 of a file, or of everything in a folder that decides what it does.

Two folders have the same hash when they hold the same files under the same names, wherever they lie. Folders that tools leave in
it (compiled modules, version control, the results of runs) do not count; a sandbox does not show them either.
"""

import hashlib
import os
import stat
from collections.abc import Iterator
from pathlib import Path

from airhockey.errors import ConfigurationError
from airhockey.inputs.names import shown

TOOLS = frozenset(
    (
        "__pycache__", "build", "dist", "runs", "node_modules", ".git", ".hg", ".venv", ".mypy_cache", ".pytest_cache",
        ".ruff_cache", ".ipynb_checkpoints", ".idea", ".vscode",
    )
)  # fmt: skip
"""Folders that tools make, and no agent reads."""
LARGEST, MOST_FILES = 8 << 30, 100_000
"""What a folder may hold: [bytes] and files. A file may say that it is larger than any disk."""
RESULTS = ("run.json", "match.json", "tournament.json")
"""A folder with one of these is a run's; that of a training is not among them: an agent may play with what was learned."""


def content_hash(path: str | os.PathLike[str]) -> str:
    """SHA-256 of a file's bytes, or of a folder's names and bytes, in hexadecimal.

    Raises:
        ConfigurationError: There is no such file, it cannot be read, or a folder holds a link or a device.
    """
    place = Path(path)
    try:
        if not place.is_dir():
            return _file_hash(place)
        whole = hashlib.sha256()
        for name, file in sorted((file.relative_to(place).as_posix(), file) for file in files_of(place)):
            whole.update(os.fsencode(name) + b"\0" + bytes.fromhex(_file_hash(file)))
        return whole.hexdigest()
    except OSError as error:
        raise ConfigurationError(f"cannot read {os.fspath(path)!r}: {error.strerror}") from None


def files_of(folder: Path) -> Iterator[Path]:
    """The files of a folder and its sub-folders that count.

    Raises:
        ConfigurationError: There is a link, a pipe or a device, or more than anybody needs.
    """
    size = 0
    for number, file in enumerate(_all_files(folder), start=1):
        size += file.stat().st_size
        if size > LARGEST or number > MOST_FILES:
            raise ConfigurationError(
                f"{shown(folder)!r} holds more than {LARGEST >> 30} GiB or {MOST_FILES:,} files; "
                "put there what the agent needs and nothing else"
            )
        yield file


def is_left_over(folder: str, name: str) -> bool:
    """Whether a folder in an agent's is one that tools or runs left there."""
    place = os.path.join(folder, name)
    return (
        name in TOOLS or name.endswith(".egg-info") or any(os.path.lexists(os.path.join(place, one)) for one in RESULTS)
    )


def _all_files(folder: Path) -> Iterator[Path]:
    with os.scandir(folder) as entries:
        there = sorted(entries, key=lambda entry: entry.name)
    for entry in there:
        kind = entry.stat(follow_symlinks=False).st_mode
        if stat.S_ISDIR(kind):
            if not is_left_over(os.fspath(folder), entry.name):
                yield from _all_files(Path(entry.path))
        elif stat.S_ISREG(kind):
            yield Path(entry.path)
        else:
            what = "a link" if stat.S_ISLNK(kind) else "neither a file nor a folder"
            raise ConfigurationError(f"{shown(entry.path)!r} is {what}; put the file itself there")


def _file_hash(file: Path) -> str:
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
