"""The project's own files: a copy to build from, and its scripts as modules."""

import importlib.util
import shutil
from pathlib import Path
from types import ModuleType

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


def load_script(root: Path, name: str) -> ModuleType:
    """A script of `scripts/` as a module."""
    spec = importlib.util.spec_from_file_location(name, root / "scripts" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
