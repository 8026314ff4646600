"""Folders of results: begun empty, written by one process at a time, never left with half a file."""

import contextlib
import errno
import fcntl
import io
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec

from airhockey.errors import AirHockeyError, ConfigurationError

JSON = msgspec.json.Encoder()
_IN_MEMORY = 256 << 20
"""Up to which size a file is made in memory, in bytes."""


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


_MOST_PACKED = 1100
"""How much smaller packing can make data."""
_DEEPEST = 3
"""Groups in groups: a group may hold itself."""


def replace_file(path: Path, content: bytes) -> None:
    """Write a file so that it is the old one or the new one, never half of it."""
    part = path.with_name(path.name + ".part")
    try:
        part.write_bytes(content)
        part.replace(path)
    except OSError:
        part.unlink(missing_ok=True)
        raise


@contextlib.contextmanager
def new_hdf5(path: Path, size: int = 0) -> Iterator[Any]:
    """An HDF5 file to be filled in the block; it has its name once it is complete.

    HDF5 ends the process where the disk is full. So a small file is made in memory and written by the operating system, which
    says so; for a large one there must be room before it is begun.

    Args:
        path: Where it is to be.
        size: About how large it will be, in bytes, where that is known to be much.

    Raises:
        OSError: There is no room for it.
    """
    import h5py

    part = path.with_suffix(".part")
    if size > _IN_MEMORY:
        room = os.statvfs(path.parent)
        if room.f_bavail * room.f_frsize < 1.1 * size:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        with h5py.File(part, "w", libver="latest") as file:
            yield file
        part.replace(path)
        return
    content = io.BytesIO()
    with h5py.File(content, "w", libver="latest") as file:
        yield file
    try:
        with part.open("wb") as raw:
            raw.write(content.getbuffer())
        part.replace(path)
    except OSError:
        part.unlink(missing_ok=True)
        raise


@contextlib.contextmanager
def disk_errors(path: Path) -> Iterator[None]:
    """What the operating system says about a disk, as an error of ours."""
    try:
        yield
    except OSError as error:
        why = error.strerror or " ".join(str(error).split())
        raise AirHockeyError(f"cannot write to {str(path)!r}: {why}; make room and go on with --resume") from error


@contextlib.contextmanager
def opened_hdf5(path: Path) -> Iterator[Any]:
    """An HDF5 file to read from. It may be a stranger's: all that it shows is its own, and no larger than it can be.

    Raises:
        OSError: It is none, or it points to other files.
    """
    import h5py

    with h5py.File(path) as file:
        _check_own(file, _MOST_PACKED * path.stat().st_size)
        yield file


def _check_own(group: Any, most: int, depth: int = 0) -> None:
    """Refuse links, data that lie in other files, and sizes that no packing explains; raises `OSError`."""
    import h5py

    for name in group:
        if depth > _DEEPEST or not isinstance(group.get(name, getlink=True), h5py.HardLink):
            raise OSError("an HDF5 file of a run holds no links")
        item = group[name]
        if isinstance(item, h5py.Group):
            _check_own(item, most, depth + 1)
        elif item.external or item.is_virtual:
            raise OSError("an HDF5 file of a run holds its data itself")
        elif item.nbytes > most:
            raise OSError(f"it says that it holds {item.nbytes:,} bytes, more than can be packed into its size")
