"""Packages of this Python."""

import importlib.metadata


def is_installed(name: str) -> bool:
    """Whether a distribution of this name is installed, whatever it is imported as."""
    try:
        importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return False
    return True
