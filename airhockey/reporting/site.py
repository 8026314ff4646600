"""The folder of a static site: begun only where there is nothing else, and rid of pages whose results are gone."""

import shutil
import zlib
from pathlib import Path

from airhockey.errors import ConfigurationError
from airhockey.evaluator.runs.disk import replace_file

MARK = ".hockey-leaderboard"
"""A file that lists what was written: only such a folder is written to again, and only these files are ever removed."""


class SiteFolder:
    """A site in the making.

    Args:
        path: A new or empty folder, or that of an earlier site.

    Attributes:
        written: Files so far, relative to the site.

    Raises:
        ConfigurationError: The folder holds something else.
    """

    def __init__(self, path: Path) -> None:
        check_place(path)
        self.path = path
        self.written: list[str] = []
        mark = path / MARK
        path.mkdir(parents=True, exist_ok=True)
        self._old = mark.read_text(encoding="utf-8").splitlines() if mark.exists() else []
        mark.touch()  # what is interrupted from here on can be written again

    @property
    def pages(self) -> int:
        """How many pages were written."""
        return sum(name.endswith(".html") for name in self.written)

    def write(self, name: str, content: str) -> None:
        """Write a page."""
        target = self.path / name
        target.parent.mkdir(parents=True, exist_ok=True)
        replace_file(target, content.encode())
        self.written.append(name)

    def copy(self, source: Path, name: str) -> None:
        """Copy a file, unless an earlier site has it already; never what a link points to."""
        if source.is_symlink():
            return
        target = self.path / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists() or target.stat().st_mtime < source.stat().st_mtime:
            shutil.copy2(source, target)
        self.written.append(name)

    def end(self) -> None:
        """Remove what an earlier site had and this one has not, and remember what this one has."""
        for name in set(self._old) - set(self.written):
            if not Path(name).is_absolute() and ".." not in Path(name).parts:
                (self.path / name).unlink(missing_ok=True)
        replace_file(self.path / MARK, "".join(f"{name}\n" for name in sorted(self.written)).encode())


def check_place(path: Path) -> None:
    """Find out whether a site may be written here; raises `ConfigurationError` where there is something else."""
    if path.exists() and not path.is_dir():
        raise ConfigurationError(f"{str(path)!r} is a file: the site needs a folder, choose another with -o")
    if path.is_dir() and any(path.iterdir()) and not (path / MARK).exists():
        raise ConfigurationError(f"{str(path)!r} holds something that is no leaderboard: choose another folder with -o")


def slug(name: str) -> str:
    """A name as part of a file's name and of a link. Two names never have the same."""
    kept = "".join(letter if letter.isascii() and (letter.isalnum() or letter in "-_.") else "_" for letter in name)
    kept = kept.lstrip(".")[:80]
    return kept if kept and kept == name else f"{kept}-{zlib.crc32(name.encode('utf-8', 'replace')):08x}"
