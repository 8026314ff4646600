"""The viewer, for `hockey watch` and `hockey replay`."""

import os
from typing import Any

import click


def show_in_viewer(show: Any, given: dict[str, Any]) -> None:
    """Show it until the user has enough."""
    from airhockey.viewing.viewer import watch

    browser = not given["no_browser"] and _has_display()
    try:
        watch(show, given["host"], given["port"], given["window"], browser, click.echo)
    except KeyboardInterrupt:
        click.echo("", err=True)
    finally:
        show.close()


def _has_display() -> bool:
    return (
        os.name != "posix"
        or os.uname().sysname == "Darwin"
        or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
    )
