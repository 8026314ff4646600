"""MuJoCo's web viewer, on the address that was asked for and no other.

The viewer listens on every interface and asks nobody for a password; it has no option for that: see
`web_guard`. Imports MuJoCo's viewer: only where something is watched.
"""

import contextlib
import logging
import queue
import socket
import time
from collections.abc import Sequence
from typing import Any

from mujoco.studio import launch_thread, viewer_protocol, web_viewer

from airhockey.envs.rendering import web_guard
from airhockey.envs.rendering.guard import Guard
from airhockey.errors import ConfigurationError

_STARTING = 30.0  # [s] that a viewer may take to begin


class BoundViewer(web_viewer.WebViewer):
    """MuJoCo's web viewer on one address.

    Args:
        host: To listen on.
        arguments: Of MuJoCo's.
    """

    def __init__(self, host: str, *arguments: Any, **named: Any) -> None:
        self._chosen_host = host
        super().__init__(*arguments, **named)

    @property
    def _host(self) -> str:
        return self._chosen_host

    @_host.setter
    def _host(self, _: str) -> None:
        """MuJoCo's choice is not taken."""

    def _start_server(self) -> None:
        """Start it under guard."""
        self.guard = Guard(self._chosen_host, self.port)
        web_guard.watch(self.guard, self.port)
        super()._start_server()

    @property
    def port(self) -> int:
        """That it listens on."""
        return int(self._http_port)


def launch(
    title: str, scene: tuple[Any, Any], host: str, port: int, plugins: Sequence[Any] = (), collects: Sequence[Any] = ()
) -> tuple[Any, str]:
    """Start the viewer in a thread of its own.

    Args:
        title: Of the page.
        scene: MuJoCo's model and data that are shown first.
        host, port: To listen on; port 0 for the first free one from 8080.
        plugins: Of the page.
        collects: Plug-ins on this side, which are told what the page sends.

    Returns:
        MuJoCo's handle and the page's address.

    Raises:
        ConfigurationError: The address cannot be listened on.
    """
    check_address(host)
    logging.getLogger("WebServer").setLevel(logging.WARNING)
    web_viewer._print_url_banner = lambda *_: None  # it names addresses that are not listened on
    ports: queue.Queue[tuple[int, str] | BaseException] = queue.Queue()

    def target(endpoint: Any) -> None:
        config = viewer_protocol.ViewerConfig(title=title, gfx="web", http_port=port)
        try:
            viewer = BoundViewer(host, config, endpoint, model=scene[0], plugins=list(plugins))
        except BaseException as error:
            ports.put(error)
            raise
        ports.put((viewer.port, viewer.guard.token))
        viewer_protocol.run_viewer_loop(viewer)

    handle = launch_thread.launch_thread(target, sim_plugins=list(collects))
    handle.model, handle.data = scene
    bound = _answer(ports)
    if isinstance(bound, BaseException):
        with contextlib.suppress(BaseException):
            handle.close()
        raise ConfigurationError(f"cannot listen on {host}:{port}: {' '.join(str(bound).split())}") from bound
    bound_port, token = bound
    _wait_until_it_listens(host, bound_port)
    return handle, f"http://{f'[{host}]' if ':' in host else host}:{bound_port}/?token={token}"


def check_address(host: str) -> None:
    """Raise `ConfigurationError` if this machine has no such address: the viewer would say that every port is taken."""
    try:
        family, kind, _, _, address = socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM)[0]
        with socket.socket(family, kind) as trial:
            trial.bind(address)
    except OSError as error:
        raise ConfigurationError(f"cannot listen on {host!r}: {error.strerror or error}") from error


def _wait_until_it_listens(host: str, port: int) -> None:
    """The server's thread begins a moment after its socket is bound; the address is told once it answers."""
    until = time.monotonic() + _STARTING
    while time.monotonic() < until:
        with contextlib.suppress(OSError), socket.create_connection((host, port), timeout=1.0):
            return
        time.sleep(0.02)


def _answer(ports: "queue.Queue[tuple[int, str] | BaseException]") -> tuple[int, str] | BaseException:
    try:
        return ports.get(timeout=_STARTING)
    except queue.Empty:
        return TimeoutError(f"the viewer did not start within {_STARTING:g} s")
