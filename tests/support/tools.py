"""What some tests need besides Python: a browser, off-screen rendering, the system library of OpenCV.

Where one is missing, a test that needs it is skipped, with the reason; only CI has to have them all, so there it runs and
fails. `AIRHOCKEY_BARE=1` (see scripts/without_graphics) says that they are hidden on purpose.
"""

import os
import shutil
from functools import cache

import pytest

from airhockey.envs.rendering.offscreen import choose_backend
from airhockey.errors import MissingDependencyError

MAY_BE_MISSING = "CI" not in os.environ or bool(os.environ.get("AIRHOCKEY_BARE"))
_CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


def chromium() -> str:
    """The browser's path."""
    if _CHROMIUM is None:
        _missing("no Chromium here: apt-get install chromium")
    return str(_CHROMIUM)


def needs_rendering() -> None:
    """Skip where nothing can be drawn off-screen."""
    if (why := _why_no_rendering()) is not None:
        _missing(why)


def needs_opencv() -> None:
    """Skip where OpenCV, which MushroomRL imports, does not load."""
    try:
        import cv2  # noqa: F401
    except ImportError as error:
        _missing(f"OpenCV does not load ({error}): apt-get install libgl1 libglib2.0-0")


@cache
def _why_no_rendering() -> str | None:
    try:
        choose_backend()
    except MissingDependencyError as error:
        return str(error)
    return None


def _missing(why: str) -> None:
    if MAY_BE_MISSING:
        pytest.skip(why)
    pytest.fail(f"CI has to have it: {why}")
