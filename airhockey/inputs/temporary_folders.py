"""Temporary folders that go away with the process, however it ends: a small shell waits for that, and removes what is left."""

import contextlib
import os
import shutil
import subprocess
import tempfile
from functools import lru_cache
from multiprocessing.util import Finalize
from pathlib import Path
from typing import Any

_WHEN_WE_ARE_GONE = 'read -r _; rm -rf -- "$1"'
_PATIENCE = 10.0
"""Longest time for the shell to remove the folders when the process ends in peace, in [s]."""


def temporary_folder(name: str) -> Path:
    """A new empty folder, for this process alone.

    Args:
        name: What it is for, as part of its own.
    """
    return Path(tempfile.mkdtemp(prefix=f"{name}-", dir=_place(os.getpid())))


@lru_cache(maxsize=1)
def _place(pid: int) -> str:
    """Where this process's folders are; a process that was forked has a place of its own."""
    place = tempfile.mkdtemp(prefix=f"airhockey-{pid}-")
    os.chmod(place, 0o711)  # another user may be shown a folder in it
    shell = _shell(place)
    # Not atexit: a worker process of multiprocessing ends without it.
    Finalize(None, _remove, args=(place, shell), exitpriority=1)
    return place


def _shell(place: str) -> Any:
    """Reads from a pipe that this process alone can write: its end is ours. It has a session of its own: Ctrl-C is not for it."""
    with contextlib.suppress(OSError):  # without one, only a process that is killed leaves anything
        return subprocess.Popen(
            ["/bin/sh", "-c", _WHEN_WE_ARE_GONE, "sh", place],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            cwd="/",
            start_new_session=True,
        )
    return None


def _remove(place: str, shell: Any) -> None:
    shutil.rmtree(place, ignore_errors=True)
    if shell is not None:
        shell.stdin.close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            shell.wait(_PATIENCE)
