"""MuJoCo's own functions, callable from compiled code.

The library that the Python bindings loaded is asked for the addresses; `add_symbol` gives them to the compiler's linker
under a name. That must happen in every process before compiled code is used, also when that code comes out of the cache on
disk (which holds the name, not the address): so it happens when this module is imported.
"""

import ctypes
import pathlib
from typing import Any

import llvmlite.binding
import mujoco
import numba

from airhockey.errors import SimulationError

_SYMBOL = "airhockey_mj_step"


def _library() -> ctypes.CDLL:
    folder = pathlib.Path(mujoco.__file__).parent
    for pattern in ("libmujoco.so*", "libmujoco*.dylib", "mujoco*.dll"):
        for path in sorted(folder.glob(pattern)):
            return ctypes.CDLL(str(path))
    raise SimulationError(f"no MuJoCo library in {folder}; reinstall it with: pip install --force-reinstall mujoco")


_LIBRARY = _library()
llvmlite.binding.add_symbol(_SYMBOL, ctypes.cast(_LIBRARY.mj_step, ctypes.c_void_p).value)

mj_step: Any = numba.types.ExternalFunction(_SYMBOL, numba.types.void(numba.types.intp, numba.types.intp))
"""`mj_step(model, data)` by address. No checks: keep the objects alive, and give it finite controls."""

_messages: list[str] = []


def _remember(message: Any) -> None:
    _messages.append(message.decode(errors="replace") if isinstance(message, bytes) else str(message))
    del _messages[:-8]


def last_warnings() -> str:
    """What the engine warned of since the last call; the messages are then forgotten."""
    text = "; ".join(dict.fromkeys(_messages))
    _messages.clear()
    return text


# Without a handler MuJoCo prints and writes MUJOCO_LOG.TXT into the working directory.
mujoco.set_mju_user_warning(_remember)
