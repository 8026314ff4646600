"""How the child process of an agent is started: plainly, or under bubblewrap."""

import functools
import os
import secrets
import shutil
import site
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import airhockey
from airhockey.agents.packaging.checkout import PACKAGE, Checkout
from airhockey.evaluator.engines.workers import ONE_THREAD
from airhockey.evaluator.isolation.interpreters import FOREIGN, Interpreter
from airhockey.evaluator.isolation.limits import Limits

BWRAP = "bwrap"
SUBMISSION = "/submission"
SCRATCH = "/tmp"
_SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64")
_SETTINGS = ("/etc/ld.so.cache", "/etc/ld.so.conf", "/etc/ld.so.conf.d", "/etc/alternatives", "/etc/localtime")
_NOT_NEEDED = (".git", ".venv", "__pycache__", "node_modules")  # of a checkout, by agents
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


def plain(checkout: Checkout | None, own: Interpreter | None = None) -> Launch:
    """A child that only has limits.

    Args:
        checkout: The submission; None for a player of the registry.
        own: The interpreter that it brings; None for ours.
    """
    scratch = tempfile.mkdtemp(prefix="airhockey-scratch-")
    start, name = (scratch, None) if checkout is None else (str(checkout.root), str(checkout.package))
    return Launch(_python(own), environment(scratch, own), start, name, temporary_folders=[scratch])


def sandboxed(checkout: Checkout | None, limits: Limits, own: Interpreter | None = None) -> Launch:
    """A child that sees the software, the root of its submission and a scratch folder in memory; no network, no other process.

    A root who starts it becomes a user of no rights, and of a number that nobody else has: the kernel counts no processes of
    root's. Everybody else gets a user namespace, with a count of its own.
    """
    temporary_folders: list[str] = []
    command = [BWRAP, *_namespaces(), *_file_system(limits.scratch, own)]
    start, inside = "/", None
    if checkout is not None:
        alone = checkout.root == checkout.package
        start = inside = f"{SUBMISSION}/{PACKAGE}" if alone else SUBMISSION
        folder = str(_readable(checkout.root, temporary_folders))
        command += ["--perms", "0755", "--dir", SUBMISSION] if alone else []
        command += ["--ro-bind", folder, inside]
    command += ["--remount-ro", "/dev", "--remount-ro", "/", "--chdir", start, "--"]
    user = _FIRST_USER + secrets.randbelow(_USERS) if is_root() else None
    return Launch([*command, *_python(own)], environment(SCRATCH, own), "/", inside, user, True, temporary_folders)


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


def environment(scratch: str, own: Interpreter | None = None) -> dict[str, str]:
    """The child's environment: nothing of the evaluator's but where software is found, and that only for our interpreter."""
    user_site = [site.getusersitepackages()] if site.ENABLE_USER_SITE else []
    ours = {
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
    if own is not None:
        del ours["PYTHONPATH"], ours["NUMBA_CACHE_LOCATOR_CLASSES"]
    return ours


@functools.cache
def is_root() -> bool:
    """Whether this is the machine's root, who can become anybody; the root of a user namespace cannot."""
    with open("/proc/self/uid_map") as users:
        return os.geteuid() == 0 and users.read().split()[:3] == ["0", "0", "4294967295"]


def _python(own: Interpreter | None = None) -> list[str]:
    if own is not None:
        return [own.path, "-I", str(FOREIGN)]
    return [sys.executable, "-P", "-m", "airhockey.evaluator.isolation.agent_process"]


def _namespaces() -> list[str]:
    """Arguments for namespaces of its own. Process 1 in there is bubblewrap's: with it all others end."""
    if not is_root():
        return ["--unshare-all", "--unshare-user", "--die-with-parent", "--new-session"]
    apart = ["--unshare-ipc", "--unshare-pid", "--unshare-net", "--unshare-uts", "--unshare-cgroup-try"]
    rights = ["--cap-drop", "ALL", "--cap-add", "CAP_SETUID", "--cap-add", "CAP_SETGID"]  # to become nobody
    return [*apart, *rights, "--die-with-parent", "--new-session"]


def _file_system(scratch: int, own: Interpreter | None = None) -> list[str]:
    """Arguments that show the system's software and Python's, read-only, and folders in memory to write to."""
    arguments: list[str] = []
    for place in _SYSTEM:
        if os.path.islink(place):
            arguments += ["--symlink", os.readlink(place), place]
        elif os.path.isdir(place):
            arguments += ["--ro-bind", place, place]
    for place in _SETTINGS:
        arguments += ["--ro-bind-try", place, place]
    arguments += ["--proc", "/proc", "--dev", "/dev"]
    for place in (SCRATCH, "/dev/shm"):
        arguments += ["--perms", "1777", "--size", str(scratch), "--tmpfs", place]
    folders = _python_folders() if own is None else _outermost([*own.folders, str(FOREIGN.parent)])
    above = {
        parent for place in folders for parent in Path(place).parents if str(parent) not in ("/", SCRATCH, *_SYSTEM)
    }
    for parent in sorted(above):
        arguments += ["--perms", "0755", "--dir", str(parent)]  # empty but for what is shown, and open to everybody
    for place in folders:
        arguments += ["--ro-bind", place, place]
    return arguments


def _python_folders() -> Sequence[str]:
    """Where the interpreter, its packages and airhockey lie, beyond the system's own folders."""
    folders = [sys.prefix, sys.base_prefix, *site.getsitepackages(), str(_package())]
    if site.ENABLE_USER_SITE:
        folders.append(site.getusersitepackages())
    return _outermost(folders)


def _outermost(folders: Sequence[str]) -> list[str]:
    """Those that exist, lie outside the system's folders, and in none of the others."""
    there = [Path(folder) for folder in dict.fromkeys(folders) if os.path.isdir(folder)]
    outside = [folder for folder in there if not any(folder.is_relative_to(place) for place in _SYSTEM)]
    outermost = [folder for folder in outside if not any(folder.is_relative_to(o) and folder != o for o in outside)]
    return [str(folder) for folder in outermost]


def _package() -> Path:
    return Path(next(iter(airhockey.__path__))).resolve()


def _readable(folder: Path, temporary_folders: list[str]) -> Path:
    """The folder, or a copy where another user could not read it; what no agent needs is not looked at."""
    if not is_root() or all(path.stat().st_mode & 0o004 for path in (folder, *_needed(folder)) if path.exists()):
        return folder
    copy = Path(tempfile.mkdtemp(prefix="airhockey-submission-"))
    temporary_folders.append(str(copy))
    shutil.copytree(folder, copy / "entry", ignore=shutil.ignore_patterns(*_NOT_NEEDED))
    for path in (copy, *copy.rglob("*")):
        path.chmod(0o755 if path.is_dir() else 0o644)
    return copy / "entry"


def _needed(folder: Path) -> Iterator[Path]:
    for path in folder.iterdir():
        if path.name not in _NOT_NEEDED:
            yield path
            if path.is_dir() and not path.is_symlink():
                yield from _needed(path)
