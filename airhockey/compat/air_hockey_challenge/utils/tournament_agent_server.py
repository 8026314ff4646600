"""An agent behind a TCP port, in the protocol of the challenge's Docker images, and its other end.

A request is one byte and, except for R, the observation as raw float64: R (an episode begins) -> r; P observation (apply the
preprocessors) -> observation; A observation -> action.
"""

import socket
from typing import Any

import numpy as np


class TournamentAgentServer:
    """Answers one player after the other.

    Args:
        agent: Has `episode_start`, `draw_action` and perhaps `preprocessors`.
        host, port: Where to listen; port 0 for any that is free.
        observation_size: Number of entries of an observation.
    """

    def __init__(self, agent: Any, host: str = "127.0.0.1", port: int = 8080, observation_size: int = 23) -> None:
        self.agent = agent
        self._bytes = 8 * observation_size
        self._socket = socket.create_server((host, port))
        self.host, self.port = self._socket.getsockname()[:2]

    def run(self, connections: int | None = None) -> None:
        """Serve this many players, or for ever."""
        with self._socket:
            while connections is None or connections > 0:
                connection, _ = self._socket.accept()
                with connection:
                    self._answer(connection)
                connections = None if connections is None else connections - 1

    def _answer(self, connection: socket.socket) -> None:
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        while (word := connection.recv(1)) in (b"R", b"P", b"A") and word:
            if word == b"R":
                self.agent.episode_start()
                connection.sendall(b"r")
                continue
            seen: Any = np.frombuffer(received(connection, self._bytes)).copy()
            if word == b"P":
                for preprocessor in getattr(self.agent, "preprocessors", ()):
                    seen = preprocessor(seen)
                connection.sendall(np.asarray(seen, dtype=np.float64).tobytes())
            else:
                connection.sendall(np.asarray(self.agent.draw_action(seen), dtype=np.float64).tobytes())


class _Connected:
    """The agent at the other end, with the interface of one in this process."""

    def __init__(self, host: str, port: int, shape: tuple[int, ...]) -> None:
        self._shape = shape
        self._socket = socket.create_connection((host, port), timeout=60.0)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.preprocessors = (self._preprocess,)

    def episode_start(self) -> None:
        """An episode begins."""
        self._socket.sendall(b"R")
        received(self._socket, 1)

    def draw_action(self, observation: Any) -> Any:
        """The next command."""
        self._socket.sendall(b"A" + np.ascontiguousarray(observation, dtype=np.float64).tobytes())
        return np.frombuffer(received(self._socket, 8 * int(np.prod(self._shape)))).reshape(self._shape).copy()

    def _preprocess(self, observation: Any) -> Any:
        raw = np.ascontiguousarray(observation, dtype=np.float64).tobytes()
        self._socket.sendall(b"P" + raw)
        return np.frombuffer(received(self._socket, len(raw))).copy()


def connect(host: str, port: int, shape: tuple[int, ...] = (2, 7)) -> Any:
    """The agent at an address: something with `episode_start`, `draw_action` and `preprocessors`."""
    return _Connected(host, port, shape)


def received(connection: socket.socket, size: int) -> bytes:
    """So many bytes; raises `ConnectionError` where the other side hangs up before."""
    data = b""
    while len(data) < size:
        chunk = connection.recv(size - len(data))
        if not chunk:
            raise ConnectionError(f"hung up after {len(data)} of {size} bytes")
        data += chunk
    return data
