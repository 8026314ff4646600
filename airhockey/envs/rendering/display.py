"""What can be shown on this machine."""

import contextlib
import os
import sys
from collections.abc import Iterator

from airhockey.errors import MissingDependencyError


def has_display() -> bool:
    """Whether a window could be opened."""
    return not sys.platform.startswith("linux") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


@contextlib.contextmanager
def needs_studio() -> Iterator[None]:
    """Import MuJoCo's viewer in this context.

    Raises:
        MissingDependencyError: MuJoCo was installed without it.
    """
    try:
        yield
    except ImportError as error:
        raise MissingDependencyError(
            f"MuJoCo's viewer is not installed ({error}): pip install 'mujoco==4.0.*'"
        ) from error
