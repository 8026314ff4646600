"""`MUJOCO_GL` of any value stops nothing that draws nothing.

MuJoCo itself would not be imported with one that does not work here.
What the user asked for is kept for whoever does draw (`airhockey.envs.rendering.offscreen`).
"""

import ctypes
import os
import sys

ASKED = "AIRHOCKEY_MUJOCO_GL"
"""Names what `MUJOCO_GL` said, where that was put aside."""
_WITHOUT_LIBRARY = frozenset(
    ("", "enable", "enabled", "on", "true", "1", "glfw", "disable", "disabled", "off", "false", "0")
)
_LIBRARIES = {"egl": ("libEGL.so.1",), "osmesa": ("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"), "glx": ()}
_ELSEWHERE = {"darwin": frozenset(("cgl",)), "win32": frozenset(("wgl",))}


def put_aside_what_does_not_work() -> None:
    """Before MuJoCo is imported for the first time; what it is asked to draw with later is another matter."""
    asked = os.environ.get("MUJOCO_GL", "")
    if "mujoco" not in sys.modules and not _works(asked.lower().strip()):
        os.environ[ASKED], os.environ["MUJOCO_GL"] = asked, "disable"


def asked_for() -> str:
    """What the user asked for."""
    return os.environ.get(ASKED) or os.environ.get("MUJOCO_GL", "")


def _works(name: str) -> bool:
    if name in _WITHOUT_LIBRARY:
        return True
    if not sys.platform.startswith("linux"):
        return name in _ELSEWHERE.get(sys.platform, ())
    return name in _LIBRARIES and (not _LIBRARIES[name] or any(map(_can_be_loaded, _LIBRARIES[name])))


def _can_be_loaded(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
