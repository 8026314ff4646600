"""The walls of a sandbox: arguments for bubblewrap, and whether this machine can build them."""

import functools
import json
import os
import secrets
import shutil
import site
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import airhockey
from airhockey.evaluator.isolation.inside_check import SOUND
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.isolation.restrict import Restrictions

BWRAP = "bwrap"
SCRATCH = "/tmp"
_NOBODY = "65534"
_SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64")
_SETTINGS = ("/etc/ld.so.cache", "/etc/ld.so.conf", "/etc/ld.so.conf.d", "/etc/alternatives", "/etc/localtime")
_OF_THE_KERNEL = tuple(
    f"/proc/{name}"
    for name in (
        "kcore", "kmsg", "kallsyms", "keys", "key-users", "vmallocinfo", "slabinfo", "timer_list", "sched_debug", "latency_stats",
        "iomem", "ioports", "kpagecount", "kpageflags", "kpagecgroup", "sysrq-trigger", "config.gz", "modules",
    )
)  # fmt: skip
"""What no agent needs to know of the kernel; root of a container owns some of it."""
_FIRST_USER, _USERS = 1 << 30, 1 << 29
_PATIENCE = 60.0  # [s] for the check


def walls(scratch: int, software: Sequence[str] | None = None) -> list[str]:
    """bubblewrap's command up to what is shown of the submission.

    Args:
        scratch: What may be written into each folder of scratch files, in bytes.
        software: Folders of the interpreter inside and its packages; None for ours.
    """
    return [
        BWRAP,
        *_namespaces(),
        *_file_system(scratch, _outermost(_python_folders() if software is None else software)),
    ]


def closing(more: Sequence[str] = ()) -> list[str]:
    """bubblewrap's last arguments before the command inside: nothing more is shown, nothing can be written, here and there."""
    places = ("/proc", "/dev", "/", *more)
    return [*(word for place in places for word in ("--remount-ro", place)), "--"]


def new_user() -> int | None:
    """The user whom a child becomes: of no rights and of a number that nobody else has, or the kernel would count processes of
    others with its own; None where a user namespace sees to that."""
    return _FIRST_USER + secrets.randbelow(_USERS) if is_root() else None


@functools.cache
def why_no_sandbox() -> str | None:
    """Why no sandbox can be had on this machine; None if it can. Builds one, and looks around in it, once."""
    if shutil.which(BWRAP) is None:
        return "bubblewrap is not installed (Debian: apt-get install bubblewrap)"
    restrictions = json.dumps(Restrictions(Limits(), new_user(), sandbox=True).to_json())
    with tempfile.NamedTemporaryFile(prefix="airhockey-canary-") as canary:
        trial = [*walls(1 << 20), *closing(), *python("inside_check"), restrictions, canary.name]
        try:
            done = subprocess.run(
                trial, capture_output=True, timeout=_PATIENCE, check=False, env=software_environment(), cwd="/"
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            return f"bubblewrap does not start: {error}"
    said = done.stdout.decode(errors="replace").strip()
    if done.returncode != 0:
        complaints = done.stderr.decode(errors="replace").strip().splitlines()
        return f"bubblewrap cannot set up a sandbox: {complaints[-1][:200] if complaints else done.returncode}"
    return None if said == SOUND else f"a sandbox here has holes: {said}"


def python(module: str) -> list[str]:
    """The command that runs a module of this folder, with nothing of the present folder on its path."""
    return [sys.executable, "-P", "-m", f"airhockey.evaluator.isolation.{module}"]


def software_environment() -> dict[str, str]:
    """Where software is found, and nothing else of the evaluator's environment."""
    user_site = [site.getusersitepackages()] if site.ENABLE_USER_SITE else []
    return {
        "PATH": "/usr/local/bin:/usr/bin:/bin",
        "LANG": "C.UTF-8",
        "PYTHONPATH": os.pathsep.join([str(_package().parent), *user_site]),
        "PYTHONDONTWRITEBYTECODE": "1",
        "PYTHONUNBUFFERED": "1",
    }


@functools.cache
def is_root() -> bool:
    """Whether this is the machine's root, who can become anybody; the root of a user namespace cannot."""
    with open("/proc/self/uid_map") as users:
        return os.geteuid() == 0 and users.read().split()[:3] == ["0", "0", "4294967295"]


def _namespaces() -> list[str]:
    """Arguments for namespaces of its own. Process 1 in there is bubblewrap's: with it all others end."""
    ending = ["--die-with-parent", "--new-session"]
    if not is_root():
        nobody = ["--unshare-user", "--uid", _NOBODY, "--gid", _NOBODY, "--cap-drop", "ALL"]
        return ["--unshare-all", *nobody, *ending]
    apart = ["--unshare-ipc", "--unshare-pid", "--unshare-net", "--unshare-uts", "--unshare-cgroup-try"]
    rights = ["--cap-drop", "ALL", "--cap-add", "CAP_SETUID", "--cap-add", "CAP_SETGID"]  # to become nobody
    return [*apart, *rights, *ending]


def _file_system(scratch: int, folders: Sequence[str]) -> list[str]:
    """Arguments that show the system's software and Python's, read-only, and folders in memory to write to.

    What can be written is mounted first: an interpreter that lies below it is then shown in it, not hidden by it.
    """
    arguments: list[str] = []
    for place in _SYSTEM:
        if os.path.islink(place):
            arguments += ["--symlink", os.readlink(place), place]
        elif os.path.isdir(place):
            arguments += ["--ro-bind", place, place]
    for place in _SETTINGS:
        arguments += ["--ro-bind-try", place, place]
    arguments += ["--proc", "/proc", "--dev", "/dev"]
    for place in filter(os.path.isfile, _OF_THE_KERNEL):
        arguments += ["--ro-bind", os.devnull, place]
    for place in (SCRATCH, "/dev/shm"):
        arguments += ["--perms", "1777", "--size", str(scratch), "--tmpfs", place]
    above = {
        parent for place in folders for parent in Path(place).parents if str(parent) not in ("/", SCRATCH, *_SYSTEM)
    }
    for parent in sorted(above):
        arguments += ["--perms", "0755", "--dir", str(parent)]  # empty but for what is shown, and open to everybody
    for place in folders:
        arguments += ["--ro-bind", place, place]
    return arguments


def _python_folders() -> Sequence[str]:
    """Where our interpreter, its packages and airhockey lie."""
    folders = [sys.prefix, sys.base_prefix, *site.getsitepackages(), str(_package())]
    if site.ENABLE_USER_SITE:
        folders.append(site.getusersitepackages())
    return folders


def _outermost(folders: Sequence[str]) -> list[str]:
    """Those that exist, lie outside the system's folders, and in none of the others."""
    there = [Path(folder) for folder in dict.fromkeys(folders) if os.path.isdir(folder)]
    outside = [folder for folder in there if not any(folder.is_relative_to(place) for place in _SYSTEM)]
    outermost = [folder for folder in outside if not any(folder.is_relative_to(o) and folder != o for o in outside)]
    return [str(folder) for folder in outermost]


def _package() -> Path:
    return Path(next(iter(airhockey.__path__))).resolve()
