"""Choosing how pictures are made on a machine without a display.

MuJoCo would decide it when it is first imported, and take a window system where `MUJOCO_GL` says nothing; and a driver that does
not work may end the process. So each backend is tried in a process of its own first, and then asked for by name.
"""

import importlib
import os
import subprocess
import sys
from typing import Any

from airhockey.envs.rendering.mujoco_gl import asked_for
from airhockey.errors import MissingDependencyError, unknown

BACKENDS = ("egl", "osmesa")
"""In the order of preference: the graphics card or Mesa through EGL, then Mesa alone."""
KNOWN = (*BACKENDS, "glfw")
"""What `MUJOCO_GL` may name."""
REMEDY = "on Debian and Ubuntu: apt-get install libegl1 libgl1 libosmesa6"
_TRIAL = """
import mujoco
model = mujoco.MjModel.from_xml_string("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
context = mujoco.GLContext(64, 64)
context.make_current()
mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
print("works", flush=True)
"""
"""What has to work. A backend whose library is missing fails in any way, as with an AttributeError while MuJoCo is imported."""
_PATIENCE = 60.0  # [s]


def choose_backend() -> str:
    """Set `MUJOCO_GL` to what works here; what the user set is left alone.

    Returns:
        The backend's name.

    Raises:
        MissingDependencyError: None works; the message names the packages that are needed.
    """
    chosen = asked_for()
    if chosen:
        return chosen
    complaints = []
    for backend in BACKENDS:
        complaint = why_not(backend)
        if complaint is None:
            os.environ["MUJOCO_GL"] = os.environ["PYOPENGL_PLATFORM"] = backend
            return backend
        complaints.append(f"{backend}: {complaint}")
    raise MissingDependencyError(f"no off-screen rendering here ({'; '.join(complaints)}); {REMEDY}")


def new_context(width: int, height: int) -> Any:
    """An off-screen context of the backend chosen, whatever MuJoCo took when it was imported.

    Raises:
        ConfigurationError: `MUJOCO_GL` names something that cannot do it.
    """
    backend = choose_backend()
    if backend not in KNOWN:
        raise unknown("value of MUJOCO_GL", backend, KNOWN)
    return importlib.import_module(f"mujoco.{backend}").GLContext(width, height)


def why_not(backend: str) -> str | None:
    """Why a backend does not work on this machine; None where it does."""
    environment = {**os.environ, "MUJOCO_GL": backend, "PYOPENGL_PLATFORM": backend}
    command = [sys.executable, "-P", "-c", _TRIAL]
    try:
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=_PATIENCE)
    except subprocess.TimeoutExpired:
        return f"no answer within {_PATIENCE:g} s"
    if "works" in done.stdout:
        return None
    lines = [line for line in done.stderr.splitlines() if line.strip() and not line.startswith(" ")]
    return (lines[-1] if lines else f"ended with status {done.returncode}")[:160]
