from pathlib import Path

from ..swaying import Sway  # noqa: F401 - the package around


def read(path):
    return Path(path).read_text()
