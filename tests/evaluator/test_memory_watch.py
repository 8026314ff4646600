"""The watch over agents' memory."""

import contextlib
import os
import socket
import threading

import pytest

from airhockey.evaluator.isolation import memory_watch


class Agent:
    """Counts the looks at it."""

    def __init__(self) -> None:
        self.looked = threading.Event()

    def look(self) -> None:
        self.looked.set()


def test_an_agent_may_be_forgotten_while_the_watch_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    """A collection in the thread that starts may close an agent; the one who starts it must not hold it up."""
    gone, held_up = Agent(), []

    thread = threading.Thread

    class Starting(thread):  # type: ignore[misc, valid-type]
        def start(self) -> None:
            collection = thread(target=memory_watch.forget, args=(gone,), daemon=True)
            collection.start()
            collection.join(5.0)
            held_up.append(collection.is_alive())
            super().start()

    monkeypatch.setattr(memory_watch, "_thread", None)
    monkeypatch.setattr(memory_watch.threading, "Thread", Starting)
    agent = Agent()
    memory_watch.watch(agent)
    assert held_up == [False]
    assert agent.looked.wait(20.0)
    memory_watch.forget(agent)


def test_sockets_of_a_namespace_are_counted() -> None:
    before = memory_watch.sockets_of(os.getpid())
    with contextlib.ExitStack() as stack:
        for family in (socket.AF_INET, socket.AF_INET, socket.AF_INET6):
            server = stack.enter_context(socket.socket(family))
            server.bind(("::1" if family == socket.AF_INET6 else "127.0.0.1", 0))
            server.listen()
            stack.enter_context(socket.create_connection(server.getsockname()[:2]))
            stack.enter_context(server.accept()[0])
        assert memory_watch.sockets_of(os.getpid()) >= before + 6
