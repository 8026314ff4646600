"""Opening an archive that somebody handed in: nothing of it is believed before it is checked.

Only zip, and of zip only files with plain names: no links, no devices, no passwords, no more bytes than allowed. Where it
brings a manifest it must be, byte for byte, what `hockey package` writes.
"""

import errno
import filecmp
import functools
import stat
import tempfile
import zipfile
import zlib
from pathlib import Path
from typing import IO

from airhockey.agents.packaging.manifest import MANIFEST, verify
from airhockey.agents.packaging.names import check_names, name_problem
from airhockey.agents.packaging.zipping import write_archive
from airhockey.errors import ConfigurationError, EnvironmentFault
from airhockey.inputs.temporary_folders import temporary_folder

MAX_FILES = 4096
MAX_BYTES = 1 << 30
"""Largest sum of all unpacked files, in bytes."""
_CHUNK = 1 << 20
_NO_ROOM = frozenset(
    (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EROFS, errno.EIO)
)
"""What the operating system says of itself, and not of an archive."""
_ENCRYPTED, _UTF8 = 0x1, 0x800


def opened(path: Path) -> Path:
    """The folder with an archive's content, unpacked once per process and removed when it ends.

    Raises:
        ConfigurationError: The archive is refused; the message names the file in it that it is refused for.
        EnvironmentFault: This machine has no room for it.
    """
    status = path.stat()
    return _opened(path.resolve(), status.st_mtime_ns, status.st_size)


@functools.lru_cache(maxsize=32)
def _opened(path: Path, changed: int, size: int) -> Path:
    folder = temporary_folder("submission")
    unpack(path, folder)
    folder.chmod(0o755)  # another user may run it in the sandbox
    return folder


def unpack(path: Path, folder: Path) -> None:
    """Unpack an archive into an empty folder.

    Raises:
        ConfigurationError: As `opened`.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            entries = [entry for entry in archive.infolist() if not _is_folder(entry)]
            _check(entries, path)
            left = MAX_BYTES
            for entry in entries:
                left -= _unpack_one(archive, entry, folder, left)
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, OSError, ValueError) as error:
        if isinstance(error, OSError) and error.errno in _NO_ROOM:
            raise EnvironmentFault(
                f"the archive {path.name!r} cannot be unpacked, which is not its fault: {error.strerror}; make room, or name a "
                "larger place by TMPDIR"
            ) from error
        if isinstance(error, ConfigurationError):
            raise ConfigurationError(f"the archive {path.name!r} is refused: {error}") from None
        raise ConfigurationError(
            f"the archive {path.name!r} is refused: it is damaged, or no zip file as `hockey package` writes it ({error})"
        ) from None
    _verify(path, folder)


def _is_folder(entry: zipfile.ZipInfo) -> bool:
    """Folders are made as files need them; one with a bad name is looked at as a file would be."""
    return entry.is_dir() and name_problem(entry.orig_filename.rstrip("/")) is None


def _check(entries: list[zipfile.ZipInfo], path: Path) -> None:
    """What can be said before anything is unpacked."""
    if len(entries) > MAX_FILES:
        raise ConfigurationError(f"it holds {len(entries)} files; {MAX_FILES} are allowed")
    for entry in entries:
        name = entry.orig_filename
        kind = stat.S_IFMT(entry.external_attr >> 16)
        if kind not in (0, stat.S_IFREG):
            raise ConfigurationError(f"{name!a} is a link or a device; only files are allowed")
        if entry.flag_bits & _ENCRYPTED:
            raise ConfigurationError(f"{name!a} is encrypted")
        if not entry.flag_bits & _UTF8 and not name.isascii():
            raise ConfigurationError(f"the file name {name!a} is not UTF-8; rename the file and pack again")
    check_names(entry.orig_filename for entry in entries)
    total = sum(entry.file_size for entry in entries)
    if total > MAX_BYTES:
        largest = max(entries, key=lambda entry: entry.file_size)
        raise ConfigurationError(
            f"unpacked it would be {total} bytes, {largest.file_size} of them {largest.filename!r}; {MAX_BYTES} are allowed"
        )


def _unpack_one(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, folder: Path, left: int) -> int:
    """Unpack a file; what the archive says about its size is not believed. Returns its size in bytes."""
    target = folder / entry.orig_filename
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with archive.open(entry) as source, target.open("xb") as sink:
            return _copy(source, sink, left)
    except (FileExistsError, NotADirectoryError):
        raise ConfigurationError(f"{entry.filename!r} is a file and a folder at once") from None
    except (RuntimeError, NotImplementedError) as error:
        raise ConfigurationError(f"{entry.filename!r} cannot be unpacked: {error}") from None


def _copy(source: IO[bytes], sink: IO[bytes], left: int) -> int:
    copied = 0
    while chunk := source.read(_CHUNK):
        copied += len(chunk)
        if copied > left:
            raise ConfigurationError(f"unpacked it is more than {MAX_BYTES} bytes, whatever it claims")
        sink.write(chunk)
    return copied


def _verify(path: Path, folder: Path) -> None:
    """An archive with a manifest is exactly what packing its files gives."""
    try:
        manifest = verify(folder)
    except ConfigurationError as error:
        raise ConfigurationError(f"the archive {path.name!r} is refused: {error}") from None
    if manifest is None:
        return
    with tempfile.TemporaryDirectory() as scratch:
        again = Path(scratch) / "again.zip"
        files = {name: folder / name for name in sorted(manifest.files)}
        write_archive(again, files, (folder / MANIFEST).read_bytes())
        if not filecmp.cmp(path, again, shallow=False):
            raise ConfigurationError(
                f"the archive {path.name!r} is refused: its files are as packed, but what holds them together was changed"
            )
