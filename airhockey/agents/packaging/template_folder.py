"""A new submission from the template that comes with the package."""

import re
import shutil
from pathlib import Path

from airhockey.agents.packaging.metadata import METADATA
from airhockey.errors import ConfigurationError

TEMPLATE = Path(__file__).parent / "template"
_TEMPLATE_NAME = "my-agent"


def make(folder: Path) -> list[str]:
    """Copy the template into a folder, named after it.

    Returns:
        The files made, relative to the folder.

    Raises:
        ConfigurationError: The folder holds something, or cannot be written.
    """
    name = re.sub(r"[^a-z0-9_.-]+", "-", folder.resolve().name.lower()).strip("-._")[:64] or _TEMPLATE_NAME
    try:
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise ConfigurationError(f"{str(folder)!r} is there already; name a folder that is new or empty")
        made = []
        for source in sorted(TEMPLATE.rglob("*")):
            if source.is_dir() or "__pycache__" in source.parts:
                continue
            target = folder / source.relative_to(TEMPLATE)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)
            made.append(target.relative_to(folder).as_posix())
        for file in (folder / METADATA, folder / "README.md"):
            file.write_text(file.read_text(encoding="utf-8").replace(_TEMPLATE_NAME, name), encoding="utf-8")
    except OSError as error:
        raise ConfigurationError(f"cannot write {str(folder)!r}: {error.strerror}") from error
    return made
