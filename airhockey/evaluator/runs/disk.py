"""Folders of results: begun empty, written by one process at a time, never left with half a file."""

import contextlib
import fcntl
import os
from collections.abc import Iterator
from pathlib import Path

import msgspec

from airhockey.errors import AirHockeyError, ConfigurationError

JSON = msgspec.json.Encoder()


def begin_folder(path: Path, name: str, manifest: msgspec.Struct) -> None:
    """Write the manifest of something new into a folder that does not exist or is empty.

    Args:
        path: The folder.
        name: The manifest's file name.
        manifest: Its content.

    Raises:
        ConfigurationError: The folder holds something, or cannot be written.
    """
    try:
        if path.is_dir() and any(path.iterdir()):
            raise ConfigurationError(
                f"{str(path)!r} is not empty: choose another --out, or continue what is in it with --resume"
            )
        path.mkdir(parents=True, exist_ok=True)
        write_record(path / name, manifest)
    except OSError as error:
        raise ConfigurationError(f"cannot write to {str(path)!r}: {error.strerror}") from error


def lock_folder(path: Path) -> int:
    """Lock a folder itself, since the files in it are replaced; released when the descriptor is closed.

    Raises:
        ConfigurationError: Another process holds it.
    """
    descriptor = os.open(path, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        raise ConfigurationError(f"another process is at work on what is in {str(path)!r}") from None
    return descriptor


def write_record(path: Path, content: msgspec.Struct) -> None:
    """Write a record as indented JSON, whole or not at all."""
    replace_file(path, msgspec.json.format(JSON.encode(content), indent=2) + b"\n")


def replace_file(path: Path, content: bytes) -> None:
    """Write a file so that it is the old one or the new one, never half of it."""
    part = path.with_name(path.name + ".part")
    part.write_bytes(content)
    part.replace(path)


@contextlib.contextmanager
def disk_errors(path: Path) -> Iterator[None]:
    """What the operating system says about a disk, as an error of ours."""
    try:
        yield
    except OSError as error:
        raise AirHockeyError(f"cannot write to {str(path)!r}: {' '.join(str(error).split())}") from error
