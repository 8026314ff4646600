"""Where a submission lies: the folder with its builder, and the root that the official image puts first on the import path.

    root/                     working directory, first on the import path, all that a sandbox shows
      air_hockey_agent/       `package`: agent_builder.py, agent_config.yml
      baseline/, utils/ …     what the agent imports beside it, weights that it opens relative to the root

A folder of another name with an `agent_builder.py` is its own root.
"""

import os
from dataclasses import dataclass
from pathlib import Path

from airhockey.errors import ConfigurationError

BUILDER, CONFIG, PACKAGE = "agent_builder.py", "agent_config.yml", "air_hockey_agent"

# What tells a repository from a folder in which several agents happen to lie.
_MARKS = (
    ".git", "air_hockey_challenge", "submission.yaml", "run.py", "setup.py", "setup.cfg", "pyproject.toml", "requirements.txt",
    "Dockerfile", "README.md",
)  # fmt: skip
_INSTALLERS = ("setup.py", "setup.cfg", "pyproject.toml")
_DEPTH = 3
"""How many folders deep a checkout is searched for its agent."""
_NOT_SEARCHED = frozenset(("__pycache__", "air_hockey_challenge", "node_modules", "site-packages", "build", "dist"))


@dataclass(frozen=True)
class Checkout:
    """A submission on disk.

    Attributes:
        root: First on the import path, and the working directory.
        package: The folder with `agent_builder.py`: the root itself, or `air_hockey_agent/` in it.
    """

    root: Path
    package: Path

    @property
    def import_path(self) -> tuple[Path, ...]:
        """Where its modules are looked for: the root, the package's folder, and `src` of a checkout that is to be installed."""
        source = self.root / "src"
        installed = source.is_dir() and any((self.root / name).is_file() for name in _INSTALLERS)
        return tuple(dict.fromkeys((self.root, self.package, *((source,) if installed else ()))))

    @property
    def own_challenge(self) -> Path | None:
        """The submission's own copy of the challenge's package, if it has one."""
        folder = self.root / "air_hockey_challenge"
        return folder if (folder / "__init__.py").is_file() or (folder / "framework").is_dir() else None

    def has_module(self, name: str) -> Path | None:
        """The file or folder of a top-level module anywhere in the submission, relative to its root; None if there is none."""
        for folder in (self.root, *_folders(self.root, _DEPTH)):
            for place in (folder / f"{name}.py", folder / name):
                if place.is_file() or (place.is_dir() and any(place.glob("*.py"))):
                    return place.relative_to(self.root)
        return None


def find_checkout(path: Path) -> Checkout:
    """Find the agent in a checkout, in `air_hockey_agent/` of one, in any folder with a builder, or in an archive.

    Args:
        path: A folder, or an archive, which is unpacked.

    Raises:
        ConfigurationError: There is no agent, more than one, or the archive is refused.
    """
    if path.is_file():
        from airhockey.agents.packaging.archive import opened

        given = opened(path)
    else:
        given = path.resolve()
    package = _package_in(given, path)
    if package.name == PACKAGE and (package != given or _is_repository(package)):
        return Checkout(package.parent, package)
    return Checkout(package, package)


def _package_in(given: Path, named: Path) -> Path:
    for folder in (given, given / PACKAGE):
        if (folder / BUILDER).is_file():
            return folder.resolve()
    found = [folder for folder in _folders(given, _DEPTH) if (folder / BUILDER).is_file()]
    packages = [folder for folder in found if folder.name == PACKAGE] or found
    if len(packages) == 1:
        return packages[0].resolve()
    where = repr(str(named))
    if packages:
        names = ", ".join(str(folder.relative_to(given)) for folder in packages[:5])
        raise ConfigurationError(f"several agents at {where}: {names}; name the folder of one")
    raise ConfigurationError(f"no agent at {where}: neither it nor its sub-folder {PACKAGE}/ contains {BUILDER}")


def _is_repository(package: Path) -> bool:
    """Whether the folder around `air_hockey_agent` is its checkout, rather than the package being a repository itself."""
    return not (package / ".git").exists() and any((package.parent / mark).exists() for mark in _MARKS)


def _folders(root: Path, depth: int) -> list[Path]:
    """Folders below `root`, nearest first, without hidden ones and without links."""
    found: list[Path] = []
    level = [root]
    for _ in range(depth):
        level = [folder for parent in level for folder in _inside(parent)]
        found += level
    return found


def _inside(folder: Path) -> list[Path]:
    try:
        with os.scandir(folder) as entries:
            names = [entry.name for entry in entries if entry.is_dir(follow_symlinks=False)]
    except OSError:
        return []
    return [folder / name for name in sorted(names) if not name.startswith(".") and name not in _NOT_SEARCHED]
