"""MuJoCo's data as bytes, so that a simulation can be saved, restored, copied and sent to another process, to the bit.

Saved is the beginning of the buffer of MuJoCo's data: positions, velocities, the solver's warm start, controls, the bodies'
poses; and the time. What comes after them there, and contacts and forces, every step computes anew.
"""

import ctypes
from typing import Any, NamedTuple

import mujoco

from airhockey.envs.copying import Copyable


class PhysicsState(NamedTuple):
    """A moment of the physics."""

    buffer: bytes
    time: float


class Physics(Copyable):
    """Saves and restores a model's data, which lives as long as this does.

    Args:
        data: MuJoCo's.
    """

    def __init__(self, data: mujoco.MjData) -> None:
        self.__setstate__(data)

    def __getstate__(self) -> mujoco.MjData:
        """All that is not an address: a copy finds the addresses of its own data."""
        return self.data

    def __setstate__(self, data: mujoco.MjData) -> None:
        self.data = data
        self._buffer = _buffer_of(data)
        counts = data.warning.number
        self._warned = _bytes_at(counts.ctypes.data, counts.strides[0] * (counts.size - 1) + counts.itemsize)
        self._nothing = bytes(len(self._warned))

    def save(self) -> PhysicsState:
        """The present moment, in memory of its own."""
        return PhysicsState(self._buffer.tobytes(), self.data.time)

    def restore(self, state: PhysicsState) -> None:
        """Go to a moment that was saved from the same model, here or in another process."""
        self._buffer[:] = state.buffer
        self.data.time = state.time
        self._warned[:] = self._nothing  # a moment is saved of a healthy simulation; this one may have diverged since


_SAVED = (
    *("qpos", "qvel", "act", "qacc_warmstart", "ctrl", "qfrc_applied", "xfrc_applied", "qacc"),
    *("xpos", "xquat", "xmat", "xipos", "ximat", "xanchor", "xaxis", "geom_xpos", "geom_xmat", "subtree_com"),
)
"""They stand at the beginning of the buffer, one after the other; what stands between them is saved, too."""


def _buffer_of(data: Any) -> memoryview:
    """The bytes from the positions, which come first, to the end of the last array that is saved."""
    first = data.qpos.ctypes.data
    size = max(
        array.ctypes.data + array.nbytes - first for array in (getattr(data, name) for name in _SAVED) if array.size
    )
    return _bytes_at(first, size)


def _bytes_at(address: int, size: int) -> memoryview:
    return memoryview((ctypes.c_uint8 * size).from_address(address)).cast("B")
