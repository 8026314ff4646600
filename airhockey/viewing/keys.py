"""Single keys typed in a terminal, without waiting for a line."""

import contextlib
import os
import select
import sys
from collections.abc import Callable, Iterator

Keys = Callable[[], str]
"""Gives what was typed since it was last asked; empty for nothing."""


@contextlib.contextmanager
def typed_keys() -> Iterator[Keys | None]:
    """Read keys while the block runs; gives None where the standard input is no terminal."""
    try:
        import termios
        import tty
    except ImportError:  # not a Unix
        yield None
        return
    if not sys.stdin or not sys.stdin.isatty():
        yield None
        return
    descriptor = sys.stdin.fileno()
    before = termios.tcgetattr(descriptor)
    try:
        tty.setcbreak(descriptor)  # Ctrl-C still interrupts
        yield lambda: _pending(descriptor)
    finally:
        termios.tcsetattr(descriptor, termios.TCSADRAIN, before)


def _pending(descriptor: int) -> str:
    typed = b""
    while select.select([descriptor], [], [], 0.0)[0]:
        read = os.read(descriptor, 64)
        if not read:
            break
        typed += read
    return typed.decode(errors="ignore")
