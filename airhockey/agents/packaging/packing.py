"""From a submission's folder to its archive: what goes in, what is left out, and why."""

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from airhockey.agents.packaging.archive import MAX_BYTES, MAX_FILES
from airhockey.agents.packaging.manifest import MANIFEST, Manifest, hash_of
from airhockey.agents.packaging.metadata import METADATA, Metadata, read_metadata
from airhockey.agents.packaging.names import check_names
from airhockey.agents.packaging.zipping import write_archive
from airhockey.agents.submission import BUILDER, submission_folder
from airhockey.errors import ConfigurationError

_CACHES = frozenset(("__pycache__", "build", "dist", "runs", "node_modules"))


@dataclass(frozen=True)
class Packed:
    """An archive that was written.

    Attributes:
        path: Where.
        sha256: Of the whole archive, in hexadecimal.
        manifest: What is in it.
        left_out: Path -> why it is not.
    """

    path: Path
    sha256: str
    manifest: Manifest
    left_out: dict[str, str]


def pack(folder: Path, target: Path | None = None) -> Packed:
    """Write the archive of a submission.

    Args:
        folder: Has `submission.yaml`, and `agent_builder.py` in it or in `air_hockey_agent/`.
        target: Where to; by default NAME-VERSION.zip in the present folder.

    Raises:
        ConfigurationError: Something about the folder is not fit to be handed in.
    """
    metadata = packable(folder)
    files, left_out = contents(folder)
    manifest = Manifest(
        name=metadata.name, version=metadata.version, files={name: hash_of(path) for name, path in files.items()}
    )
    target = target or Path(f"{metadata.name}-{metadata.version}.zip")
    part = target.with_name(target.name + ".part")
    try:
        write_archive(part, files, manifest.encode())
        part.replace(target)
    except OSError as error:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        raise ConfigurationError(f"cannot write {str(target)!r}: {error.strerror}") from error
    return Packed(target, hash_of(target).sha256, manifest, left_out)


def packable(folder: Path) -> Metadata:
    """The metadata of a folder that can be packed; raises `ConfigurationError` for one that cannot."""
    if not folder.is_dir():
        raise ConfigurationError(f"there is no folder {str(folder)!r} to pack")
    submission_folder(folder)
    if not (folder / METADATA).is_file():
        raise ConfigurationError(f"{str(folder)!r} has no {METADATA}; `hockey new` shows what it looks like")
    metadata = read_metadata(folder)
    assert metadata is not None
    return metadata


def contents(folder: Path) -> tuple[dict[str, Path], dict[str, str]]:
    """What is packed, path in the archive -> file, in the archive's order; and what is left out, path -> why.

    Raises:
        ConfigurationError: Too much, or a name that is not usable.
    """
    files: dict[str, Path] = {}
    left_out: dict[str, str] = {}
    for path, why in _walk(folder):
        name = path.relative_to(folder).as_posix()
        if why is None:
            files[name] = path
        else:
            left_out[name] = why
    files = dict(sorted(files.items()))
    check_names(files)
    total = sum(path.stat().st_size for path in files.values())
    if len(files) > MAX_FILES or total > MAX_BYTES:
        raise ConfigurationError(
            f"{len(files)} files of {total} bytes together are too much: {MAX_FILES} files and {MAX_BYTES} bytes are allowed"
        )
    if not any(name in (BUILDER, f"air_hockey_agent/{BUILDER}") for name in files):
        raise ConfigurationError(f"{BUILDER} itself would be left out: {left_out}")
    return files, left_out


def _walk(folder: Path) -> Iterator[tuple[Path, str | None]]:
    """Everything in a folder, and why it is left out; what is in a folder that is left out is not listed."""
    for path in sorted(folder.iterdir()):
        why = _why_not(path)
        if why is None and path.is_dir():
            yield from _walk(path)
        else:
            yield path, why


def _why_not(path: Path) -> str | None:
    if path.is_symlink():
        return "a link: its target may not be there elsewhere"
    if path.name in _CACHES or path.suffix in (".pyc", ".pyo") or path.name.endswith(".egg-info"):
        return "made by tools, not by you"
    if path.name.startswith("."):
        return "hidden"
    if path.name == MANIFEST:
        return "written anew"
    if not path.is_dir() and not path.is_file():
        return "neither a file nor a folder"
    return None
