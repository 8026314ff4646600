"""The product under attack: its commands in a process of their own, and what they leave behind."""

import contextlib
import ctypes
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PATIENCE = 600.0
"""Longest time for a command, in [s]; beyond that it hangs."""
CACHES_OF_OTHERS = ("torchinductor_",)
"""Beginnings of names of folders that PyTorch keeps for its next run."""
WANTED = ""
"""Only attacks whose names hold this are wanted."""
_PR_SET_CHILD_SUBREAPER = 36


@dataclass
class Done:
    """A command that ended, or was ended.

    Attributes:
        status: Exit status; None where it hung.
        leftovers: Processes and files that outlived it.
    """

    status: int | None
    out: str
    err: str
    leftovers: list[str] = field(default_factory=list)

    @property
    def has_traceback(self) -> bool:
        """Whether the user was shown a traceback, or the interpreter crashed."""
        crashed = self.status is not None and self.status < 0 and -self.status not in (signal.SIGKILL, signal.SIGTERM)
        return crashed or any("Traceback (most recent call last)" in text for text in (self.out, self.err))


@dataclass
class Place:
    """A fresh home: a working folder, a folder for temporary files, an environment of its own.

    Attributes:
        path: The working folder.
    """

    path: Path
    temporary: Path

    def environment(self, more: Mapping[str, str] | None = None) -> dict[str, str]:
        """What its processes are started with."""
        return {**os.environ, "TMPDIR": str(self.temporary), "COLUMNS": "200", **(more or {})}

    def start(self, command: Sequence[str], **given: object) -> "subprocess.Popen[bytes]":
        """Start a command in a session of its own."""
        settings: dict[str, object] = {
            "cwd": self.path,
            "env": self.environment(),
            "stdin": subprocess.DEVNULL,
            "stdout": subprocess.PIPE,
            "stderr": subprocess.PIPE,
            "start_new_session": True,
        }
        return subprocess.Popen(command, **{**settings, **given})  # type: ignore[call-overload, no-any-return]

    def run(self, command: Sequence[str], patience: float = PATIENCE, **given: object) -> Done:
        """Run a command to its end."""
        process = self.start(command, **given)
        try:
            out, err = process.communicate(timeout=patience)
            status: int | None = process.returncode
        except subprocess.TimeoutExpired:
            kill_all()
            out, err = process.communicate()
            status = None
        return Done(status, text(out), text(err), self.leftovers())

    def hockey(self, *arguments: str, patience: float = PATIENCE, **given: object) -> Done:
        """Run a `hockey` command."""
        return self.run(hockey(*arguments), patience, **given)

    def leftovers(self) -> list[str]:
        """Processes that still run, and temporary files that are still there, a moment later."""
        end = time.monotonic() + 5.0
        while (found := self._left()) and time.monotonic() < end:
            time.sleep(0.1)
        return found

    def _left(self) -> list[str]:
        processes = [f"{name} ({pid})" for pid, name in orphans().items()]
        return processes + sorted(
            path.name for path in self.temporary.iterdir() if not path.name.startswith(CACHES_OF_OTHERS)
        )


def hockey(*arguments: str) -> list[str]:
    """The command line of a `hockey` command, as its console script runs it."""
    return [str(Path(sys.executable).with_name("hockey")), *arguments]


@contextlib.contextmanager
def fresh_place() -> Iterator[Place]:
    """A place that is there for the block; everything that still runs there is ended afterwards."""
    root = Path(tempfile.mkdtemp(prefix="airhockey-attack-"))
    root.chmod(0o755)
    place = Place(root / "work", root / "temporary")
    place.path.mkdir()
    place.temporary.mkdir()
    place.temporary.chmod(0o1777)
    try:
        yield place
    finally:
        kill_all()
        shutil.rmtree(root, ignore_errors=True)


def adopt_orphans() -> None:
    """Let every process whose parent has ended become a child of this one, so that none escapes the count."""
    ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def orphans() -> dict[int, str]:
    """The living descendants of this process, number -> name; the dead are cleared away."""
    parents: dict[int, tuple[int, str, str]] = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            with contextlib.suppress(OSError, IndexError):
                name, _, rest = (entry / "stat").read_text().partition(" (")[2].rpartition(") ")
                state, parent = rest.split()[:2]
                parents[int(entry.name)] = (int(parent), state, name)
    found: dict[int, str] = {}
    new = {os.getpid()}
    while new:
        new = {pid for pid, (parent, _, _) in parents.items() if parent in new and pid not in found}
        found |= {pid: parents[pid][2] for pid in new}
    for pid in [pid for pid in found if parents[pid][1] == "Z"]:
        del found[pid]
        with contextlib.suppress(OSError):
            os.waitpid(pid, os.WNOHANG)
    return found


def kill_all() -> None:
    """End every descendant of this process."""
    for _ in range(20):
        living = orphans()
        for pid in living:
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGKILL)
        if not living:
            break
        time.sleep(0.05)


def text(raw: bytes | None) -> str:
    """What was printed; bytes that are no text show as such."""
    return (raw or b"").decode("utf-8", "replace")


def last_line(done: Done) -> str:
    """The last line of what it complained about."""
    lines = [line.strip() for line in (done.err or done.out).splitlines() if line.strip()]
    return lines[-1][:300] if lines else ""


def wanted(names: Iterable[str]) -> list[str]:
    """Those of these attacks that are asked for."""
    return [name for name in names if WANTED in name]
