"""An agent behind a TCP port, seen from the agent: the counterpart of `remote.py`, one player at a time."""

import select
import socket
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from airhockey.errors import ConfigurationError
from airhockey.evaluator.isolation.handle import AgentHandle
from airhockey.evaluator.isolation.remote import ACT, PREPROCESS, RESET, RESET_DONE

LOOPBACK = "127.0.0.1"
SILENCE = 10.0
"""How long a player may be silent while another one waits, or take for a request once it has begun, in [s]."""


def listen(host: str, port: int) -> socket.socket:
    """A socket that waits for players; raises `ConfigurationError` where there is none to be had."""
    try:
        return socket.create_server((host, port), family=socket.AF_INET6 if ":" in host else socket.AF_INET)
    except OSError as error:
        raise ConfigurationError(f"cannot listen on {host}:{port}: {error.strerror or error}") from None


def serve(waiting: socket.socket, agent: AgentHandle, size: int, games: int | None = None) -> None:
    """Answer one connection after the other.

    Args:
        waiting: From `listen`.
        agent: Who answers.
        size: Number of entries of an observation.
        games: After how many connections to end; None for never.
    """
    while games is None or games > 0:
        connection, _ = waiting.accept()
        with connection:
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            try:
                answer_all(connection, agent, size, waiting)
            except OSError:
                continue  # it hung up in the middle
        games = None if games is None else games - 1


def answer_all(connection: socket.socket, agent: AgentHandle, size: int, waiting: socket.socket | None = None) -> None:
    """Answer requests until the other side hangs up, says something else, or is silent while others wait.

    Args:
        connection: To the player.
        agent: Who answers.
        size: Number of entries of an observation.
        waiting: Where others wait.
    """
    answers: dict[bytes, Callable[[], bytes]] = {}

    def observation() -> Any:
        return np.frombuffer(_receive(connection, 8 * size)).copy()

    def reset() -> bytes:
        agent.episode_start()
        return RESET_DONE

    def preprocess() -> bytes:
        seen = observation()
        for preprocessor in agent.preprocessors:
            seen = preprocessor(seen)
        return np.asarray(seen, dtype=np.float64).tobytes()

    def act() -> bytes:
        return np.asarray(agent.act(observation()), dtype=np.float64).tobytes()

    answers = {RESET: reset, PREPROCESS: preprocess, ACT: act}
    while (word := _next_word(connection, waiting)) in answers:
        connection.settimeout(SILENCE)
        connection.sendall(answers[word]())


def _next_word(connection: socket.socket, waiting: socket.socket | None) -> bytes:
    """The next request; nothing where the other side has hung up, or is silent for long while somebody else waits."""
    silent_since = time.monotonic()
    while not select.select([connection], [], [], 1.0)[0]:
        somebody_waits = waiting is not None and bool(select.select([waiting], [], [], 0.0)[0])
        if somebody_waits and time.monotonic() - silent_since > SILENCE:
            return b""
    return connection.recv(1)


def _receive(connection: socket.socket, size: int) -> bytes:
    """So many bytes of a request; there is one deadline for all of them, or who sends one after the other holds up the rest."""
    received, deadline = b"", time.monotonic() + SILENCE
    while len(received) < size:
        left = deadline - time.monotonic()
        if left <= 0.0:
            raise TimeoutError
        connection.settimeout(left)
        chunk = connection.recv(size - len(received))
        if not chunk:
            raise ConnectionError("hung up")
        received += chunk
    connection.settimeout(SILENCE)
    return received
