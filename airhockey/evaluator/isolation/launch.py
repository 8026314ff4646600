"""How the child process of an agent is started: plainly, or in a sandbox."""

import shutil
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from airhockey.evaluator.engines.workers import ONE_THREAD
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
from airhockey.inputs.hashing import TOOLS, files_of

SUBMISSION = "/submission"


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


def plain(folder: Path | None) -> Launch:
    """A child that only has limits.

    Args:
        folder: The submission's, with `agent_builder.py`; None for a player of the registry.
    """
    scratch = tempfile.mkdtemp(prefix="airhockey-scratch-")
    start = scratch if folder is None else str(folder.parent if folder.name == "air_hockey_agent" else folder)
    name = None if folder is None else str(folder)
    return Launch(_command(), environment(scratch), start, name, temporary_folders=[scratch])


def sandboxed(folder: Path | None, limits: Limits) -> Launch:
    """A child that sees the software, its submission and a scratch folder in memory; no network, no other process.

    Raises:
        ConfigurationError: The submission holds a link, a pipe or a device.
    """
    temporary_folders: list[str] = []
    command = walls(limits.scratch)
    inside = None
    if folder is not None:
        inside = f"{SUBMISSION}/air_hockey_agent"
        shown = str(_readable(folder, temporary_folders))
        command += ["--perms", "0755", "--dir", SUBMISSION, "--ro-bind", shown, inside, "--chdir", SUBMISSION]
    command += [*closing(), *_command()]
    return Launch(command, environment(SCRATCH), "/", inside, new_user(), True, temporary_folders)


def environment(scratch: str) -> dict[str, str]:
    """The child's environment: nothing of the evaluator's but where software is found."""
    return {
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


def _command() -> list[str]:
    return python("agent_process")


def _readable(folder: Path, temporary_folders: list[str]) -> Path:
    """The folder, or a copy where another user could not read it."""
    files = list(files_of(folder))
    places = {folder, *files, *(parent for file in files for parent in file.parents if parent.is_relative_to(folder))}
    if not is_root() or all(place.stat().st_mode & (0o005 if place.is_dir() else 0o004) for place in places):
        return folder
    copy = Path(tempfile.mkdtemp(prefix="airhockey-submission-"))
    temporary_folders.append(str(copy))
    target = copy / "air_hockey_agent"
    shutil.copytree(folder, target, symlinks=True, ignore=shutil.ignore_patterns(*TOOLS))
    for path in (copy, target, *target.rglob("*")):
        if not path.is_symlink():
            path.chmod(0o755 if path.is_dir() else 0o644)
    return target
