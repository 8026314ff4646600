"""Random streams whose state is saved and restored as bytes: through NumPy's dictionaries that costs 3 µs each way.

NumPy says where a bit generator's state lies (`bit_generator.ctypes.state_address`), but promises nothing about what is there.
So it is tried out once in every process; where a PCG64 lies otherwise than expected, its dictionary serves as before.
"""

import ctypes
import struct
from functools import cache
from typing import Any

import numpy as np

from airhockey.envs.copying import Copyable

_POINTER = 8
_LAYOUT = struct.Struct("<II8xQQQQ")
"""The state of a PCG64: a pointer of 8 bytes, then what is saved: whether half a draw is left, the half, and, where the pointer
points, state and increment of 128 bits each."""


class Stream(Copyable):
    """Saves and restores a generator, which lives as long as this does.

    Attributes:
        generator: NumPy's, with a PCG64.
    """

    def __init__(self, generator: np.random.Generator) -> None:
        self.__setstate__(generator)

    def save(self) -> Any:
        """The present state, in memory of its own."""
        return self.generator.bit_generator.state if self._bytes is None else self._bytes.tobytes()

    def restore(self, state: Any) -> None:
        """Go back to a state that was saved of this generator, or of one like it."""
        if self._bytes is not None and type(state) is bytes:
            self._bytes[:] = state
        else:
            self.generator.bit_generator.state = _told(state) if isinstance(state, bytes) else state

    def __getstate__(self) -> np.random.Generator:
        """All that is not an address: a copy finds that of its own generator."""
        return self.generator

    def __setstate__(self, generator: np.random.Generator) -> None:
        self.generator = generator
        bits = generator.bit_generator
        self._bytes = _bytes_of(bits) if type(bits) is np.random.PCG64 and _is_as_expected() else None


def _bytes_of(bits: Any) -> memoryview:
    """What is saved, where it lies."""
    place = (ctypes.c_uint8 * _LAYOUT.size).from_address(bits.ctypes.state_address + _POINTER)
    return memoryview(place).cast("B")


def _told(state: bytes) -> dict[str, Any]:
    """The same as NumPy's dictionary."""
    half_is_left, half, low, high, low_increment, high_increment = _LAYOUT.unpack(state)
    return {
        "bit_generator": "PCG64",
        "state": {"state": low | high << 64, "inc": low_increment | high_increment << 64},
        "has_uint32": half_is_left,
        "uinteger": half,
    }


@cache
def _is_as_expected() -> bool:
    """Whether reading and writing where the state should lie reads and writes the state."""
    bits, other = np.random.PCG64(1), np.random.PCG64(2)
    address = bits.ctypes.state_address
    if ctypes.c_uint64.from_address(address).value != address + _POINTER + 16:
        return False
    for generator in (bits, other):
        np.random.Generator(generator).integers(0, 2**32, dtype=np.uint32)  # leaves half a draw
    if _told(_bytes_of(bits).tobytes()) != bits.state:
        return False
    _bytes_of(bits)[:] = _bytes_of(other)
    return bits.state == other.state
