"""An agent behind a TCP port, in the protocol of the challenge's Docker images.

A request is one byte and, except for R, the observation as raw float64 in the machine's own order:

    R                   an episode begins                 -> r
    P observation       apply the preprocessors           -> observation
    A observation       the next command                  -> action

The action's shape is not transmitted: it follows from the interpolation order.
"""

import socket
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.actions import ActionFormat
from airhockey.envs.copying import NotCopyable
from airhockey.evaluator.isolation.failures import AgentDied, AgentError, AgentTimeout
from airhockey.evaluator.isolation.handle import AgentHandle
from airhockey.evaluator.isolation.modes import host_and_port

Array = NDArray[np.float64]
RESET, RESET_DONE, PREPROCESS, ACT = b"R", b"r", b"P", b"A"
_CONNECT = 10.0  # [s] to connect


class RemoteAgent(NotCopyable, AgentHandle):
    """The agent at the other end of a connection.

    Args:
        address: tcp://HOST:PORT.
        env_info: Of the environment that is played.
        order: Interpolation order of the actions that come.
        patience: Longest time for an answer, in [s].

    Raises:
        ConfigurationError: The address has no meaning.
        AgentError: Nobody answers there.
    """

    phase = "remote"

    def __init__(self, address: str, env_info: Mapping[str, Any], order: int | None, patience: float) -> None:
        self.interpolation_order = order
        self._shape = ActionFormat(order, env_info["robot"]["n_joints"]).shape
        self._address, self._patience = address, patience
        try:
            self._socket = socket.create_connection(host_and_port(address), timeout=min(_CONNECT, patience))
        except OSError as error:
            raise AgentDied(f"nobody answers at {address}: {error}") from None
        self._socket.settimeout(patience)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    @property
    def isolation(self) -> str:
        """It is somewhere else."""
        return "remote"

    @property
    def preprocessors(self) -> tuple[Callable[[Array], Array], ...]:
        """The agent's own, which are applied over there."""
        return (self._preprocess,)

    def episode_start(self) -> None:
        """An episode begins."""
        if self._exchange(RESET, 1) != RESET_DONE:
            raise self._broken("it did not confirm the start of the episode")

    def act(self, observation: Array) -> Array:
        """The next command, in the shape of the interpolation order."""
        count = int(np.prod(self._shape))
        return np.frombuffer(self._exchange(ACT + _raw(observation), 8 * count)).reshape(self._shape).copy()

    def stop(self) -> None:
        """Hang up."""
        self._socket.close()

    def close(self) -> None:
        """Hang up."""
        self._socket.close()

    def clock(self, kind: str) -> Callable[[], float]:
        """Wall time: nobody can see its CPU from here."""
        return time.perf_counter

    def _preprocess(self, observation: Array) -> Array:
        size = np.asarray(observation).size
        return np.frombuffer(self._exchange(PREPROCESS + _raw(observation), 8 * size)).copy()

    def _exchange(self, request: bytes, size: int) -> bytes:
        """Send a request and receive as many bytes as the answer must have."""
        try:
            self._refuse_leftovers()
            deadline = time.monotonic() + self._patience
            self._socket.settimeout(self._patience)
            self._socket.sendall(request)
            answer = b""
            while len(answer) < size:
                left = deadline - time.monotonic()  # for the answer, not for each of its bytes
                if left <= 0.0:
                    raise TimeoutError
                self._socket.settimeout(left)
                chunk = self._socket.recv(size - len(answer))
                if not chunk:
                    raise self._broken(f"it hung up after {len(answer)} of {size} bytes")
                answer += chunk
        except TimeoutError:
            self.stop()
            raise AgentTimeout(f"{self._address} did not answer within {self._patience:g} s") from None
        except OSError as error:
            raise self._broken(str(error)) from None
        return answer

    def _refuse_leftovers(self) -> None:
        """Bytes that nobody asked for would be taken for the next answer."""
        self._socket.setblocking(False)
        try:
            extra = self._socket.recv(1)
        except BlockingIOError:
            return
        raise self._broken("its last answer was too long for the interpolation order" if extra else "it hung up")

    def _broken(self, why: str) -> AgentError:
        self.stop()
        return AgentDied(f"{self._address}: {why}")


def _raw(observation: Array) -> bytes:
    return np.ascontiguousarray(observation, dtype=np.float64).tobytes()
