"""How the child process of an agent is started: plainly, or under bubblewrap."""

import functools
import os
import secrets
import shutil
import site
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import airhockey
from airhockey.evaluator.engines.workers import ONE_THREAD
from airhockey.evaluator.isolation.limits import Limits

BWRAP = "bwrap"
SUBMISSION = "/submission"
SCRATCH = "/tmp"
_SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64")
_SETTINGS = ("/etc/ld.so.cache", "/etc/ld.so.conf", "/etc/ld.so.conf.d", "/etc/alternatives", "/etc/localtime")
_FIRST_USER, _USERS = 1 << 30, 1 << 29


@dataclass
class Launch:
    """What is needed to start a child, and to clean up after it.

    Attributes:
        command: Without the numbers of the pipes.
        environment: All of it.
        folder: Where the child starts.
        submission: The path by which the child knows the submission; None for a player of the registry.
        user: Number of the user whom the child becomes; None to stay who it is.
        counted: Whether its processes are counted apart from everybody else's.
        temporary_folders: Folders to remove afterwards.
    """

    command: list[str]
    environment: dict[str, str]
    folder: str
    submission: str | None
    user: int | None = None
    counted: bool = False
    temporary_folders: list[str] = field(default_factory=list)


def plain(folder: Path | None) -> Launch:
    """A child that only has limits.

    Args:
        folder: The submission's, with `agent_builder.py`; None for a player of the registry.
    """
    scratch = tempfile.mkdtemp(prefix="airhockey-scratch-")
    start = scratch if folder is None else str(folder.parent if folder.name == "air_hockey_agent" else folder)
    name = None if folder is None else str(folder)
    return Launch(_python(), environment(scratch), start, name, temporary_folders=[scratch])


def sandboxed(folder: Path | None, limits: Limits) -> Launch:
    """A child that sees the software, its submission and a scratch folder in memory; no network, no other process.

    A root who starts it becomes a user of no rights, and of a number that nobody else has: the kernel counts no processes of
    root's. Everybody else gets a user namespace, with a count of its own.
    """
    temporary_folders: list[str] = []
    command = [BWRAP, *_namespaces(), *_file_system(limits.scratch)]
    inside = None
    if folder is not None:
        inside = f"{SUBMISSION}/air_hockey_agent"
        command += [
            "--perms",
            "0755",
            "--dir",
            SUBMISSION,
            "--ro-bind",
            str(_readable(folder, temporary_folders)),
            inside,
        ]
    command += ["--remount-ro", "/dev", "--remount-ro", "/", "--chdir", "/" if folder is None else SUBMISSION, "--"]
    user = _FIRST_USER + secrets.randbelow(_USERS) if is_root() else None
    return Launch([*command, *_python()], environment(SCRATCH), "/", inside, user, True, temporary_folders)


@functools.cache
def why_no_sandbox() -> str | None:
    """Why no sandbox can be had on this machine; None if it can. Tries it once."""
    if shutil.which(BWRAP) is None:
        return "bubblewrap is not installed (Debian: apt-get install bubblewrap)"
    trial = [BWRAP, *_namespaces(), *_file_system(1 << 20), "--remount-ro", "/", "--", sys.executable, "-c", "pass"]
    try:
        done = subprocess.run(trial, capture_output=True, timeout=30, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"bubblewrap does not start: {error}"
    if done.returncode != 0:
        return f"bubblewrap cannot set up a sandbox: {done.stderr.decode(errors='replace').strip()[:200]}"
    return None


def environment(scratch: str) -> dict[str, str]:
    """The child's environment: nothing of the evaluator's but where software is found."""
    user_site = [site.getusersitepackages()] if site.ENABLE_USER_SITE else []
    return {
        "PATH": "/usr/local/bin:/usr/bin:/bin",
        "HOME": scratch,
        "TMPDIR": scratch,
        "LANG": "C.UTF-8",
        "PYTHONPATH": os.pathsep.join([str(_package().parent), *user_site]),
        "PYTHONDONTWRITEBYTECODE": "1",
        "PYTHONUNBUFFERED": "1",
        "MPLCONFIGDIR": scratch,
        "NUMBA_CACHE_LOCATOR_CLASSES": (
            "airhockey.evaluator.isolation.numba_cache.ReadOnlyCache,"
            "UserProvidedCacheLocator,InTreeCacheLocator,UserWideCacheLocator"
        ),
        **ONE_THREAD,
    }


@functools.cache
def is_root() -> bool:
    """Whether this is the machine's root, who can become anybody; the root of a user namespace cannot."""
    with open("/proc/self/uid_map") as users:
        return os.geteuid() == 0 and users.read().split()[:3] == ["0", "0", "4294967295"]


def _python() -> list[str]:
    return [sys.executable, "-P", "-m", "airhockey.evaluator.isolation.agent_process"]


def _namespaces() -> list[str]:
    """Arguments for namespaces of its own. Process 1 in there is bubblewrap's: with it all others end."""
    if not is_root():
        return ["--unshare-all", "--unshare-user", "--die-with-parent", "--new-session"]
    apart = ["--unshare-ipc", "--unshare-pid", "--unshare-net", "--unshare-uts", "--unshare-cgroup-try"]
    rights = ["--cap-drop", "ALL", "--cap-add", "CAP_SETUID", "--cap-add", "CAP_SETGID"]  # to become nobody
    return [*apart, *rights, "--die-with-parent", "--new-session"]


def _file_system(scratch: int) -> list[str]:
    """Arguments that show the system's software and Python's, read-only, and folders in memory to write to."""
    arguments: list[str] = []
    for place in _SYSTEM:
        if os.path.islink(place):
            arguments += ["--symlink", os.readlink(place), place]
        elif os.path.isdir(place):
            arguments += ["--ro-bind", place, place]
    for place in _SETTINGS:
        arguments += ["--ro-bind-try", place, place]
    folders = _python_folders()
    above = {parent for place in folders for parent in Path(place).parents if str(parent) not in ("/", *_SYSTEM)}
    for parent in sorted(above):
        arguments += ["--perms", "0755", "--dir", str(parent)]  # empty but for what is shown, and open to everybody
    for place in folders:
        arguments += ["--ro-bind", place, place]
    arguments += ["--proc", "/proc", "--dev", "/dev"]
    for place in (SCRATCH, "/dev/shm"):
        arguments += ["--perms", "1777", "--size", str(scratch), "--tmpfs", place]
    return arguments


def _python_folders() -> Sequence[str]:
    """Where the interpreter, its packages and airhockey lie, beyond the system's own folders."""
    folders = [sys.prefix, sys.base_prefix, *site.getsitepackages(), str(_package())]
    if site.ENABLE_USER_SITE:
        folders.append(site.getusersitepackages())
    there = [Path(folder) for folder in dict.fromkeys(folders) if os.path.isdir(folder)]
    outside = [folder for folder in there if not any(folder.is_relative_to(place) for place in _SYSTEM)]
    outermost = [folder for folder in outside if not any(folder.is_relative_to(o) and folder != o for o in outside)]
    return [str(folder) for folder in outermost]


def _package() -> Path:
    return Path(next(iter(airhockey.__path__))).resolve()


def _readable(folder: Path, temporary_folders: list[str]) -> Path:
    """The folder, or a copy where another user could not read it."""
    if not is_root() or all(path.stat().st_mode & 0o004 for path in (folder, *folder.rglob("*")) if path.exists()):
        return folder
    copy = Path(tempfile.mkdtemp(prefix="airhockey-submission-"))
    temporary_folders.append(str(copy))
    shutil.copytree(folder, copy / "air_hockey_agent")
    for path in (copy, *copy.rglob("*")):
        path.chmod(0o755 if path.is_dir() else 0o644)
    return copy / "air_hockey_agent"
