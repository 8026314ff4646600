"""Showing a show in MuJoCo's own viewer: in the browser, or in a window."""

import contextlib
import logging
import queue
import socket
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

from airhockey.errors import ConfigurationError, MissingDependencyError
from airhockey.viewing.keys import typed_keys
from airhockey.viewing.show import Show
from airhockey.viewing.transport import KEYS, Transport

LOOPBACK = "127.0.0.1"
_FRAME = 1 / 60  # [s]
_STARTING = 30.0  # [s] that a viewer may take to begin
TITLE = "airhockey"


def watch(
    show: Show,
    host: str = LOOPBACK,
    port: int = 0,
    window: bool = False,
    open_browser: bool = False,
    say: Callable[[str], None] = print,
) -> None:
    """Show a show until the user has enough.

    Args:
        show: Begun.
        host: Address to listen on; the viewer asks nobody for a password.
        port: To listen on; 0 for the first free one from 8080.
        window: In a native window instead of a browser.
        open_browser: Also open the page.
        say: Told the address, and what keys do.

    Raises:
        ConfigurationError: The address cannot be listened on, or there is no display for a window.
        MissingDependencyError: MuJoCo was installed without its viewer.
    """
    launched = _launch_window(show) if window else _launch_web(show, host, port, open_browser)
    handle, address, hears = launched
    if address:
        say(f"watch at {address} (Ctrl-C ends)")
        if host not in (LOOPBACK, "localhost", "::1"):
            say(f"anybody who can reach {host} can watch and press the buttons: there is no password")
    transport = Transport(show, time.monotonic)
    with handle, typed_keys() as keys:
        if keys is not None:
            say("keys: " + ", ".join(f"{'space' if key.key == ' ' else key.key} {key.label}" for key in KEYS))
        _loop(handle, transport, hears, keys, wait=not window)


def _loop(handle: Any, transport: Transport, hears: Any, keys: Callable[[], str] | None, wait: bool) -> None:
    """Hear, step, show, sleep. A web viewer's show begins when the first page is open, or a key is pressed."""
    waiting = wait
    while transport.running and handle.is_running():
        began = time.monotonic()
        stage = transport.show.stage
        for command, step in hears.take():
            waiting = False
            if command == "seek":
                transport.seek(step)
            else:
                transport.do(command)
        for key in keys() if keys is not None else "":
            waiting = False
            transport.do(next((known.command for known in KEYS if known.key == key), ""))
        if waiting:
            transport.do_nothing()
        else:
            transport.run()
        if transport.show.stage is not stage:
            handle.set_model(transport.show.stage.model, data=transport.show.stage.data)
        handle.send_to_viewer(view_of(transport))
        handle.sync()
        time.sleep(max(0.001, _FRAME - (time.monotonic() - began)))


def view_of(transport: Transport) -> Any:
    """What the panel is told."""
    from airhockey.viewing.panel import View

    show = transport.show
    return View(
        show.caption(), tuple(show.marks()), show.step, show.steps, show.episode, show.episodes, show.can_go_back,
        transport.paused, transport.speed, show.stage.robots,
    )  # fmt: skip


def _launch_web(show: Show, host: str, port: int, open_browser: bool) -> tuple[Any, str, Any]:
    """The web viewer in a thread of its own; gives its handle, its address and what hears the panel."""
    _check_address(host)
    with _needs_studio():
        from mujoco.studio import launch_thread, viewer_protocol, web_viewer

        from airhockey.viewing.ears import Ears
        from airhockey.viewing.panel import Panel
    logging.getLogger("WebServer").setLevel(logging.WARNING)
    web_viewer._print_url_banner = lambda *_: None  # it names addresses that are not listened on
    ports: queue.Queue[int | BaseException] = queue.Queue()

    class BoundViewer(web_viewer.WebViewer):
        """MuJoCo's viewer, which would listen on every interface, on the one that was asked for."""

        @property
        def _host(self) -> str:
            return host

        @_host.setter
        def _host(self, _: str) -> None:
            """MuJoCo's choice is not taken."""

    def target(endpoint: Any) -> None:
        config = viewer_protocol.ViewerConfig(title=TITLE, gfx="web", http_port=port)
        try:
            viewer = BoundViewer(config, endpoint, model=show.stage.model, plugins=[Panel()])
        except BaseException as error:
            ports.put(error)
            raise
        ports.put(viewer._http_port)
        viewer_protocol.run_viewer_loop(viewer)

    ears = Ears()
    handle = launch_thread.launch_thread(target, sim_plugins=[ears])
    handle.model, handle.data = show.stage.model, show.stage.data
    bound = _answer(ports)
    if isinstance(bound, BaseException):
        with contextlib.suppress(BaseException):
            handle.close()
        raise ConfigurationError(f"cannot listen on {host}:{port}: {' '.join(str(bound).split())}") from bound
    _wait_until_it_listens(host, bound)
    address = f"http://{f'[{host}]' if ':' in host else host}:{bound}/"
    if open_browser:
        _open(address)
    return handle, address, ears


def _check_address(host: str) -> None:
    """Whether this machine has the address: MuJoCo's viewer would only say that every port of it is taken."""
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


def _answer(ports: "queue.Queue[int | BaseException]") -> int | BaseException:
    try:
        return ports.get(timeout=_STARTING)
    except queue.Empty:
        return TimeoutError(f"the viewer did not start within {_STARTING:g} s")


def _launch_window(show: Show) -> tuple[Any, str, Any]:
    """The native viewer."""
    import os

    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise ConfigurationError("there is no display for a window: leave out --window and watch in a browser")
    with _needs_studio():
        from mujoco.studio import launch_native, viewer_protocol

        from airhockey.viewing.ears import Ears
        from airhockey.viewing.panel import Panel
    ears = Ears()
    handle = launch_native.launch(viewer_protocol.ViewerConfig(title=TITLE), plugins=[Panel(), ears])
    handle.set_model(show.stage.model, data=show.stage.data)
    return handle, "", ears


@contextlib.contextmanager
def _needs_studio() -> Iterator[None]:
    try:
        yield
    except ImportError as error:
        raise MissingDependencyError(
            f"MuJoCo's viewer is not installed ({error}): pip install 'mujoco==4.0.*'"
        ) from error


def _open(address: str) -> None:
    import threading
    import webbrowser

    threading.Thread(target=webbrowser.open, args=(address,), kwargs={"new": 2}, daemon=True).start()
