"""Showing a show in MuJoCo's own viewer: in the browser, or in a window."""

import contextlib
import os
import sys
import threading
import time
import webbrowser
from collections.abc import Callable, Iterator
from typing import Any

from airhockey.errors import ConfigurationError, MissingDependencyError
from airhockey.viewing.keys import typed_keys
from airhockey.viewing.playback import Show
from airhockey.viewing.playback_controls import KEYS, Transport

LOOPBACK = "127.0.0.1"
_FRAME = 1 / 60  # [s]
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
    """The web viewer; gives its handle, its address and what hears the panel."""
    with _needs_studio():
        from airhockey.viewing.web import launch
    handle, address, ears = launch(TITLE, show.stage.model, show.stage.data, host, port)
    if open_browser:
        threading.Thread(target=webbrowser.open, args=(address,), kwargs={"new": 2}, daemon=True).start()
    return handle, address, ears


def _launch_window(show: Show) -> tuple[Any, str, Any]:
    """The native viewer."""
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise ConfigurationError("there is no display for a window: leave out --window and watch in a browser")
    with _needs_studio():
        from mujoco.studio import launch_native, viewer_protocol

        from airhockey.viewing.key_commands import Ears
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
