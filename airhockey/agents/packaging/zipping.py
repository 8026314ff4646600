"""The bytes of an archive: the same files give the same ones, on any day and under any umask.

Files are stored, not compressed: compressed bytes depend on the version of zlib.
"""

import stat
import zipfile
from pathlib import Path

from airhockey.agents.packaging.manifest import MANIFEST

_EPOCH = (1980, 1, 1, 0, 0, 0)
_UNIX = 3


def write_archive(target: Path, files: dict[str, Path], manifest: bytes) -> None:
    """Write an archive.

    Args:
        target: Where to.
        files: Path in the archive -> file, in the archive's order.
        manifest: What `MANIFEST.json`, the first of them, holds.
    """
    with zipfile.ZipFile(target, "w", zipfile.ZIP_STORED) as archive:
        archive.writestr(_entry(MANIFEST), manifest)
        for name, path in files.items():
            archive.writestr(_entry(name), path.read_bytes())


def _entry(name: str) -> zipfile.ZipInfo:
    entry = zipfile.ZipInfo(name, _EPOCH)
    entry.create_system = _UNIX  # wherever it is packed
    entry.external_attr = (stat.S_IFREG | 0o644) << 16
    return entry
