"""The memory that evaluator and agent share, and the two pipes by which they wake each other.

    offset      what                                      written by
    0           length of the text, in bytes              the sender
    8           number of dimensions of the action        agent
    16          its shape, up to 4 numbers                agent
    64          the observation                           evaluator
    4096        the action                                agent
    65536       text: JSON                                the sender

A request on a pipe is one byte, and eight that nobody can foresee; the reply is one byte and the same eight, so that none can
be written in advance. The evaluator believes nothing that it reads: it copies, and checks. The memory's size is sealed, or an
agent that truncated it would kill the evaluator.
"""

import fcntl
import json
import math
import mmap
import os
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.copying import NotCopyable
from airhockey.evaluator.isolation.failures import AgentError

Array = NDArray[np.float64]

BUILD, EPISODE, ACT, STOP = b"B", b"E", b"A", b"S"
HELLO, DONE, RAISED, BAD_ACTION = b"H", b"K", b"X", b"N"

NONCE = 8
MESSAGE = 1 + NONCE
"""Length of a request and of a reply, in bytes."""
OBSERVATION, ACTION, TEXT, SIZE = 64, 4096, 65536, 131072
MAX_DIMENSIONS = 4
MAX_ACTION = (TEXT - ACTION) // 8
_SEALS = 0x1 | 0x2 | 0x4  # F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW
_F_ADD_SEALS = 1033
_DESCRIPTION = struct.Struct(f"={1 + MAX_DIMENSIONS}q")  # of an action: number of dimensions, shape


class Nonces:
    """Bytes that nobody can foresee, `NONCE` at a time; drawn from the system's generator for many requests at once."""

    def __init__(self) -> None:
        self._drawn, self._place = b"", 0

    def next(self) -> bytes:
        """The next ones."""
        begin = self._place
        if begin >= len(self._drawn):
            self._drawn, begin = os.urandom(512 * NONCE), 0
        self._place = begin + NONCE
        return self._drawn[begin : self._place]


def new_memory() -> int:
    """A file descriptor of fresh shared memory, of a size that nobody can change."""
    descriptor = os.memfd_create("airhockey", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    os.ftruncate(descriptor, SIZE)
    fcntl.fcntl(descriptor, _F_ADD_SEALS, _SEALS)
    return descriptor


def _shape(dimensions: int, *sizes: int) -> tuple[int, ...]:
    """The shape that a header describes; raises `AgentError` where that is none."""
    shape = sizes[:dimensions] if 0 <= dimensions <= MAX_DIMENSIONS else (-1,)
    if min(shape, default=1) < 0 or math.prod(shape) > MAX_ACTION:
        raise AgentError(f"the shared memory holds no action: shape {shape}")
    return shape


class Memory(NotCopyable):
    """One side's view of the shared memory."""

    def __init__(self, descriptor: int) -> None:
        self._map = mmap.mmap(descriptor, SIZE)
        self._header = np.frombuffer(self._map, np.int64, 2 + MAX_DIMENSIONS)
        self._observation = np.frombuffer(self._map, np.float64, (ACTION - OBSERVATION) // 8, OBSERVATION)
        self._action = np.frombuffer(self._map, np.float64, MAX_ACTION, ACTION)
        self._described: tuple[int, ...] = ()
        self._shape: tuple[int, ...] = ()

    def write_observation(self, observation: Array) -> None:
        """Put an observation where the agent reads it. Shape (d,)."""
        self._observation[: observation.size] = observation

    def read_observation(self, size: int) -> Array:
        """A copy of the observation. Shape (size,)."""
        return self._observation[:size].copy()

    def write_action(self, action: Array) -> None:
        """Put an action where the evaluator reads it. At most 4 dimensions and `MAX_ACTION` entries."""
        _DESCRIPTION.pack_into(self._map, 8, action.ndim, *action.shape, *(0,) * (MAX_DIMENSIONS - action.ndim))
        self._action[: action.size] = action.reshape(-1)

    def read_action(self) -> Array:
        """A copy of the action; raises `AgentError` for a header that describes none."""
        described = _DESCRIPTION.unpack_from(self._map, 8)
        if described != self._described:  # most agents give one shape for ever
            self._described, self._shape = described, _shape(*described)
        action = self._action[: math.prod(self._shape)].copy()
        action.shape = self._shape
        return action

    def write_text(self, content: Any) -> None:
        """Put something that JSON knows where the other side reads it."""
        text = json.dumps(content).encode()
        if len(text) > SIZE - TEXT:
            raise AgentError(f"a message of {len(text)} bytes is too long")
        self._map[TEXT : TEXT + len(text)] = text
        self._header[0] = len(text)

    def read_text(self) -> Any:
        """What the other side put there; raises `AgentError` where that is not JSON."""
        length = min(max(int(self._header[0]), 0), SIZE - TEXT)
        try:
            return json.loads(self._map[TEXT : TEXT + length])
        except (ValueError, RecursionError):
            raise AgentError("its message is not JSON") from None
