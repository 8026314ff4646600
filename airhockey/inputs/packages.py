"""Packages of this Python."""

import contextlib
import importlib.metadata
from collections.abc import Iterator

from airhockey.errors import MissingDependencyError


@contextlib.contextmanager
def needs(who: str, what: str, extra: str) -> Iterator[None]:
    """Import packages of an extra in this context.

    Args:
        who: Needs them, as "this interface".
        what: The package's own name.
        extra: Of this distribution, that brings it.

    Raises:
        MissingDependencyError: It cannot be imported; the message says what to install.
    """
    try:
        yield
    except ImportError as error:
        raise MissingDependencyError(
            f"{who} needs {what}, which cannot be imported ({error}); install it with: pip install 'airhockey[{extra}]'"
        ) from error


def is_installed(name: str) -> bool:
    """Whether a distribution of this name is installed, whatever it is imported as."""
    try:
        importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return False
    return True
