"""MuJoCo's own viewer, in the browser or in a window, with the playback that it shows."""

import threading
import time
import webbrowser
from collections.abc import Callable
from typing import Any

from airhockey.envs.rendering.display import has_display, needs_studio
from airhockey.errors import ConfigurationError
from airhockey.viewing.keys import typed_keys
from airhockey.viewing.playback import Playback
from airhockey.viewing.playback_controls import KEYS, PlaybackControls

LOOPBACK = "127.0.0.1"
_FRAME = 1 / 60  # [s]
TITLE = "airhockey"


def show_playback(
    playback: Playback,
    host: str = LOOPBACK,
    port: int = 0,
    window: bool = False,
    open_browser: bool = False,
    say: Callable[[str], None] = print,
) -> None:
    """Show a playback until the user has enough.

    Args:
        playback: Begun.
        host: Address to listen on; the viewer asks nobody for a password.
        port: To listen on; 0 for the first free one from 8080.
        window: In a native window instead of a browser.
        open_browser: Also open the page.
        say: Told the address, and what keys do.

    Raises:
        ConfigurationError: The address cannot be listened on, or there is no display for a window.
        MissingDependencyError: MuJoCo was installed without its viewer.
    """
    launched = _launch_window(playback) if window else _launch_web(playback, host, port, open_browser)
    handle, address, commands = launched
    if address:
        say(f"watch at {address} (Ctrl-C ends)")
        if host not in (LOOPBACK, "localhost", "::1"):
            say(f"anybody who can reach {host} can watch and press the buttons: there is no password")
    controls = PlaybackControls(playback, time.monotonic)
    with handle, typed_keys() as keys:
        if keys is not None:
            say("keys: " + ", ".join(f"{'space' if key.key == ' ' else key.key} {key.label}" for key in KEYS))
        _loop(handle, controls, commands, keys, wait=not window)


def _loop(handle: Any, controls: PlaybackControls, commands: Any, keys: Callable[[], str] | None, wait: bool) -> None:
    """Take commands, step, draw, sleep. In a web viewer the playback begins when the first page is open, or a key is pressed."""
    waiting = wait
    while controls.running and handle.is_running():
        began = time.monotonic()
        scene_view = controls.playback.scene_view
        for command, step in commands.take():
            waiting = False
            if command == "seek":
                controls.seek(step)
            else:
                controls.do(command)
        for key in keys() if keys is not None else "":
            waiting = False
            controls.do(next((known.command for known in KEYS if known.key == key), ""))
        if waiting:
            controls.do_nothing()
        else:
            controls.run()
        if controls.playback.scene_view is not scene_view:
            handle.set_model(controls.playback.scene_view.model, data=controls.playback.scene_view.data)
        handle.send_to_viewer(state_of(controls))
        handle.sync()
        time.sleep(max(0.001, _FRAME - (time.monotonic() - began)))


def state_of(controls: PlaybackControls) -> Any:
    """What the panel shows."""
    from airhockey.viewing.panel import PlaybackState

    playback = controls.playback
    return PlaybackState(
        playback.caption(), tuple(playback.marks()), playback.step, playback.steps, playback.episode,
        playback.episodes, playback.can_go_back, controls.paused, controls.speed, playback.scene_view.robots,
    )  # fmt: skip


def _launch_web(playback: Playback, host: str, port: int, open_browser: bool) -> tuple[Any, str, Any]:
    """The web viewer; gives its handle, its address and what collects the commands of panel and keys."""
    with needs_studio():
        from airhockey.envs.rendering.web import launch
        from airhockey.viewing.key_commands import KeyCommands
        from airhockey.viewing.panel import Panel
    commands, view = KeyCommands(), playback.scene_view
    handle, address = launch(TITLE, (view.model, view.data), host, port, [Panel()], [commands])
    if open_browser:
        threading.Thread(target=webbrowser.open, args=(address,), kwargs={"new": 2}, daemon=True).start()
    return handle, address, commands


def _launch_window(playback: Playback) -> tuple[Any, str, Any]:
    """The native viewer."""
    if not has_display():
        raise ConfigurationError("there is no display for a window: leave out --window and watch in a browser")
    with needs_studio():
        from mujoco.studio import launch_native, viewer_protocol

        from airhockey.viewing.key_commands import KeyCommands
        from airhockey.viewing.panel import Panel
    commands = KeyCommands()
    handle = launch_native.launch(viewer_protocol.ViewerConfig(title=TITLE), plugins=[Panel(), commands])
    handle.set_model(playback.scene_view.model, data=playback.scene_view.data)
    return handle, "", commands
