"""A page of this machine that shows an environment live, from a process of its own.

MuJoCo's web viewer draws into one context for a whole process: it crashes one that opens a second viewer, or that ends while
one is open, as scripts and notebooks do.
"""

import os
import select
import signal
import subprocess
import sys
import time
import weakref
from typing import IO, Any

import numpy as np

from airhockey.envs.rendering.display import needs_studio
from airhockey.errors import AirHockeyError, EnvironmentFault

_HOST = "127.0.0.1"
_STARTING = 60.0  # [s] that the process may take to begin
_ENDING = 5.0  # [s] that it may take to end
_FRAME, _IDLE = 0.01, 0.1  # [s] between two pictures at least, and at most


class LivePage:
    """Shows the present moment of a scene; says on the standard error where.

    Args:
        env, edition: Of the environment.

    Raises:
        MissingDependencyError: MuJoCo was installed without its viewer.
        EnvironmentFault: The page could not be opened; the message says why.
    """

    def __init__(self, env: str, edition: str) -> None:
        with needs_studio():
            import mujoco.studio  # noqa: F401
        command = [sys.executable, "-P", "-m", __name__, env, edition]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        assert self._process.stdin is not None and self._process.stdout is not None
        self._moments, self._closed = self._process.stdin, False
        os.set_blocking(self._moments.fileno(), False)
        weakref.finalize(self, self._moments.close)  # or subprocess would keep the page of an environment that is gone
        answered, _, _ = select.select([self._process.stdout], [], [], _STARTING)
        said = self._process.stdout.readline().decode().strip() if answered else f"no answer within {_STARTING:g} s"
        if not said.startswith("http"):
            self.close()
            raise EnvironmentFault(f"the page cannot be opened: {said or 'its process ended'}")
        print(f"watch at {said}", file=sys.stderr)

    def is_running(self) -> bool:
        """Whether it is open."""
        return not self._closed and self._process.poll() is None

    def show(self, data: Any) -> None:
        """Show what an `MjData` of the scene says; a moment that comes before the page has shown the last ones is left out."""
        moment = np.concatenate([data.qpos, data.qvel, [data.time]]).tobytes()
        try:
            os.write(self._moments.fileno(), moment)  # far below the size that a pipe takes whole
        except BlockingIOError:
            pass
        except OSError:
            self.close()

    def close(self) -> None:
        """End the page."""
        self._closed = True
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()
        try:
            self._process.wait(_ENDING)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


def main(env: str, edition: str) -> None:
    """Show what comes on the standard input, until it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever shows says when it is over
    try:
        with needs_studio():
            from airhockey.envs.rendering.web import launch
        from airhockey.envs.rendering.scene_view import SceneView

        view = SceneView(env, edition)
        handle, address = launch("airhockey", (view.model, view.data), _HOST, 0)
    except AirHockeyError as error:
        print(error, flush=True)
        return
    print(address, flush=True)
    _show(sys.stdin.buffer, view, handle)


def _show(moments: IO[bytes], view: Any, handle: Any) -> None:
    """Show the latest moment of those that have come, again and again."""
    counts = np.cumsum([view.data.qpos.size, view.data.qvel.size])
    size = 8 * (int(counts[-1]) + 1)
    os.set_blocking(moments.fileno(), False)
    kept = b""
    while handle.is_running():
        try:
            come = os.read(moments.fileno(), 1 << 16)
        except BlockingIOError:
            come = None
        if come == b"":
            break
        kept += come or b""
        whole = len(kept) // size * size
        if whole:
            position, velocity, (now,) = np.split(np.frombuffer(kept[whole - size : whole]), counts)
            view.place(position, velocity, now)
            kept = kept[whole:]
        handle.sync()
        time.sleep(_FRAME)
        select.select([moments], [], [], _IDLE)
    os._exit(0)  # the viewer's own threads need not be waited for


if __name__ == "__main__":
    main(*sys.argv[1:])
