"""Threads that an agent left in this process do not keep a command alive that has done its work."""

import os
import sys
import threading
import time

GRACE = 5.0
"""How long they may take to end, in [s]. What must be cleared away after a process is cleared away without it."""


def end_with(status: int) -> None:
    """Let the interpreter end within `GRACE` from now, with this exit status."""
    others = [one for one in threading.enumerate() if one is not threading.main_thread() and not one.daemon]
    if others:
        threading.Thread(target=_end, args=(status,), daemon=True).start()


def _end(status: int) -> None:
    time.sleep(GRACE)
    sys.stderr.flush()
    os._exit(status)
