"""How the child process of an agent is started: plainly, or in a sandbox."""

import os
import shutil
from dataclasses import dataclass, field
from pathlib import Path

from airhockey.agents.packaging.checkout import PACKAGE, Checkout
from airhockey.evaluator.engines.workers import ONE_THREAD
from airhockey.evaluator.isolation.interpreters import FOREIGN, Interpreter
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.isolation.sandbox import (
    SCRATCH,
    closing,
    is_root,
    new_user,
    python,
    software_environment,
    walls,
)
from airhockey.inputs.hashing import files_of, is_left_over
from airhockey.inputs.temporary_folders import temporary_folder

SUBMISSION = "/submission"
_NOTHING = 4096  # [bytes]


@dataclass
class Launch:
    """What is needed to start a child, and to clean up after it.

    Attributes:
        command: Without the numbers of the pipes.
        environment: All of it.
        folder: Where the child starts.
        submission: The path by which the child knows the submission; None for a player of the registry.
        user: Number of the user whom the child becomes; None to stay who it is.
        sandbox: Whether it runs in a sandbox.
        temporary_folders: Folders to remove afterwards.
    """

    command: list[str]
    environment: dict[str, str]
    folder: str
    submission: str | None
    user: int | None = None
    sandbox: bool = False
    temporary_folders: list[str] = field(default_factory=list)


def plain(checkout: Checkout | None, own: Interpreter | None = None) -> Launch:
    """A child that only has limits.

    Args:
        checkout: The submission; None for a player of the registry.
        own: The interpreter that it brings; None for ours.
    """
    scratch = str(temporary_folder("scratch"))
    root = None if checkout is None else str(checkout.root)
    return Launch(_command(own), environment(scratch, own), root or scratch, root, temporary_folders=[scratch])


def sandboxed(checkout: Checkout | None, limits: Limits, own: Interpreter | None = None) -> Launch:
    """A child that sees the software, the root of its submission and a scratch folder in memory; no network, no other process.

    Raises:
        ConfigurationError: The submission holds a link, a pipe or a device.
    """
    temporary_folders: list[str] = []
    hidden: list[str] = []
    command = walls(limits.scratch, None if own is None else [*own.folders, str(FOREIGN.parent)])
    inside = None
    if checkout is not None:
        alone = checkout.root == checkout.package
        inside = f"{SUBMISSION}/{PACKAGE}" if alone else SUBMISSION
        folder = _readable(checkout.root, temporary_folders)
        hidden = [f"{inside}/{place}" for place in _left_over(folder)]
        command += ["--perms", "0755", "--dir", SUBMISSION] if alone else []
        command += ["--ro-bind", str(folder), inside, "--chdir", inside]
        for place in hidden:  # nor may compiled code be other than its source
            command += ["--perms", "0755", "--size", str(_NOTHING), "--tmpfs", place]
    command += [*closing(hidden), *_command(own)]
    return Launch(command, environment(SCRATCH, own), "/", inside, new_user(), True, temporary_folders)


def environment(scratch: str, own: Interpreter | None = None) -> dict[str, str]:
    """The child's environment: nothing of the evaluator's but where software is found, and that only for our interpreter."""
    ours = {
        **software_environment(),
        "HOME": scratch,
        "TMPDIR": scratch,
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


def _command(own: Interpreter | None) -> list[str]:
    return python("agent_process") if own is None else [own.path, "-I", str(FOREIGN)]


def _left_over(folder: Path) -> list[str]:
    """The folders in a submission which do not count and therefore are not shown."""
    found: list[str] = []
    for place, names, _ in os.walk(folder):
        hidden = [name for name in names if is_left_over(place, name)]
        found += [os.path.relpath(os.path.join(place, name), folder) for name in hidden]
        names[:] = [name for name in names if name not in hidden]
    return found


def _readable(folder: Path, temporary_folders: list[str]) -> Path:
    """The folder, or a copy where another user could not read it; what tools leave in it is not looked at."""
    files = list(files_of(folder))
    places = {folder, *files, *(parent for file in files for parent in file.parents if parent.is_relative_to(folder))}
    if not is_root() or all(place.stat().st_mode & (0o005 if place.is_dir() else 0o004) for place in places):
        return folder
    copy = temporary_folder("submission")
    temporary_folders.append(str(copy))
    target = copy / "entry"
    shutil.copytree(folder, target, symlinks=True, ignore=_ignored)
    for path in (copy, target, *target.rglob("*")):
        if not path.is_symlink():
            path.chmod(0o755 if path.is_dir() else 0o644)
    return target


def _ignored(folder: str, names: list[str]) -> list[str]:
    """Which of these names in a folder are not copied."""
    return [name for name in names if os.path.isdir(os.path.join(folder, name)) and is_left_over(folder, name)]
