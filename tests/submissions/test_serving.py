"""An agent behind a port: whoever is silent, slow or rude holds up nobody for long."""

import contextlib
import socket
import threading
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from airhockey.agents.build import build_agent
from airhockey.envs import make
from airhockey.evaluator.isolation import serving
from airhockey.evaluator.isolation.handle import LocalAgent
from airhockey.evaluator.isolation.remote import RemoteAgent

SILENCE = 0.3


@pytest.fixture
def port(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """Of a server that offers `hold` and loses patience soon."""
    monkeypatch.setattr(serving, "SILENCE", SILENCE)
    env = make("3dof-hit")
    agent = LocalAgent(build_agent("hold", env.env_info))
    with serving.listen(serving.LOOPBACK, 0) as waiting:
        arguments = (waiting, agent, env.reset(seed=0).size, 2)
        server = threading.Thread(target=serving.serve, args=arguments, daemon=True)
        server.start()
        yield waiting.getsockname()[1]
        for _ in range(2):  # one that hangs up at once counts, one that was hung up on does not
            with contextlib.suppress(OSError):
                socket.create_connection(waiting.getsockname()).close()
            server.join(1.0)
        assert not server.is_alive()


def silent(rude: socket.socket) -> None:
    """Say nothing."""
    time.sleep(4 * SILENCE)


def slow(rude: socket.socket) -> None:
    """Begin a request, and send a byte of it now and then."""
    rude.sendall(b"A")
    with contextlib.suppress(OSError):
        for _ in range(40):
            rude.sendall(b"\0")
            time.sleep(SILENCE / 3)


def deaf(rude: socket.socket) -> None:
    """Ask and ask, and read no answer."""
    requests = (b"P" + bytes(8 * make("3dof-hit").reset(seed=0).size)) * 1000
    rude.settimeout(3 * SILENCE)
    with contextlib.suppress(OSError):
        while True:
            rude.sendall(requests)


def wrong(rude: socket.socket) -> None:
    """Say what nobody understands."""
    rude.sendall(b"GET / HTTP/1.1\r\n\r\n")


@pytest.mark.parametrize("behave", [silent, slow, deaf, wrong])
def test_one_that_is_rude_holds_up_nobody_for_long(port: int, behave: Callable[[socket.socket], None]) -> None:
    env = make("3dof-hit")
    with socket.create_connection((serving.LOOPBACK, port)) as rude:
        rudeness = threading.Thread(target=behave, args=(rude,), daemon=True)
        rudeness.start()
        time.sleep(0.05)
        began = time.monotonic()
        honest = RemoteAgent(f"tcp://127.0.0.1:{port}", env.env_info, 3, patience=8.0)
        honest.episode_start()
        observation = env.reset(seed=1)
        joints = env.env_info["joint_pos_ids"]
        np.testing.assert_array_equal(honest.act(observation)[0], observation[joints])
        honest.stop()
        assert time.monotonic() - began < 8 * SILENCE + 2.0
        rude.close()
        rudeness.join(10.0)
