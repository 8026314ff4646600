"""`MANIFEST.json`: the hash of every file in an archive, so that a changed one is known by name."""

import hashlib
from pathlib import Path

import msgspec

from airhockey.errors import ConfigurationError

MANIFEST = "MANIFEST.json"


class FileHash(msgspec.Struct, frozen=True):
    """A file's size in bytes and its SHA-256 in hexadecimal."""

    bytes: int
    sha256: str


class Manifest(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What is in an archive.

    Attributes:
        name, version: Of the submission.
        files: Path in the archive -> its hash.
        format: Of this file.
    """

    name: str
    version: str
    files: dict[str, FileHash]
    format: int = 1

    def encode(self) -> bytes:
        """The bytes of `MANIFEST.json`; the same manifest gives the same bytes."""
        return msgspec.json.format(msgspec.json.encode(self), indent=1) + b"\n"


def hash_of(file: Path) -> FileHash:
    """Size and hash of a file."""
    with file.open("rb") as stream:
        digest = hashlib.file_digest(stream, "sha256").hexdigest()
    return FileHash(file.stat().st_size, digest)


def verify(folder: Path) -> Manifest | None:
    """Compare what lies in a folder with the manifest in it, if there is one.

    Raises:
        ConfigurationError: A file was changed, is missing, or is not in the manifest; it is named.
    """
    if not (folder / MANIFEST).is_file():
        return None
    try:
        manifest = msgspec.json.decode((folder / MANIFEST).read_bytes(), type=Manifest)
    except (msgspec.MsgspecError, UnicodeDecodeError) as error:
        raise ConfigurationError(f"{MANIFEST} is damaged ({error}); pack the submission again") from None
    there = {path.relative_to(folder).as_posix(): path for path in sorted(folder.rglob("*")) if path.is_file()}
    del there[MANIFEST]
    for name in sorted(manifest.files.keys() - there.keys()):
        raise ConfigurationError(f"the file {name!r} is in the manifest but not in the archive; pack it again")
    for name, path in there.items():
        if name not in manifest.files:
            raise ConfigurationError(f"the file {name!r} is not in the archive's manifest; it was added later")
        if hash_of(path) != manifest.files[name]:
            raise ConfigurationError(f"the file {name!r} is not the one that was packed: its hash differs")
    return manifest
