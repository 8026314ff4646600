"""The viewer, for `hockey watch` and `hockey replay`."""

import os
from typing import Any

import click


def show_in_viewer(playback: Any, given: dict[str, Any]) -> None:
    """Show it until the user has enough."""
    from airhockey.viewing.viewer import show_playback

    browser = not given["no_browser"] and has_display()
    try:
        show_playback(playback, given["host"], given["port"], given["window"], browser, click.echo)
    except KeyboardInterrupt:
        click.echo("", err=True)
    finally:
        playback.close()


def has_display() -> bool:
    """Whether a browser can be opened here."""
    return (
        os.name != "posix"
        or os.uname().sysname == "Darwin"
        or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
    )
