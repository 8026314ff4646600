"""A copy of the project's sources, to build from."""

import shutil
from pathlib import Path

_AT_THE_ROOT = {"runs", "build", "dist", "tests", "site"}


def copy_sources(root: Path, target: Path) -> None:
    """Copy the project without what tools and runs leave; links stay links."""

    def left_out(folder: str, names: list[str]) -> list[str]:
        at_the_root = _AT_THE_ROOT if Path(folder) == root else set()
        return [
            name
            for name in names
            if name.startswith(".") or name == "__pycache__" or name.endswith(".egg-info") or name in at_the_root
        ]

    shutil.copytree(root, target, symlinks=True, ignore=left_out)
