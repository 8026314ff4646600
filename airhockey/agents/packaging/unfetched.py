"""What of a checkout git has not fetched: submodules that were left empty, and large files of which only pointers are there."""

from pathlib import Path

from airhockey.errors import ConfigurationError
from airhockey.inputs.hashing import files_of

_POINTER = b"version https://git-lfs.github.com/spec/"
FETCH = "git lfs pull, in the checkout"
"""What fetches large files."""
_LARGEST_POINTER = 1024
"""Size of a pointer of Git LFS at most, in bytes, as its specification says."""


def empty_submodule(root: Path, module: str) -> str | None:
    """The submodule in which a module should lie and which holds no code; None where there is none.

    Args:
        root: Of the checkout.
        module: Its whole name, as it is imported.
    """
    try:
        told = (root / ".gitmodules").read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return None
    names = module.split(".")
    lines = (line.partition("=") for line in told.splitlines())
    for path in (value.strip() for key, _, value in lines if key.strip() == "path"):
        parts = list(Path(path).parts)
        is_meant = names[: len(parts)] == parts or names[0] in parts[-1:]
        if is_meant and not any((root / path).glob("**/*.py")):
            return path
    return None


def pointers(root: Path) -> list[str]:
    """The files of a checkout that are pointers of Git LFS instead of what they should hold."""
    found = []
    try:
        for file in files_of(root):
            if file.stat().st_size <= _LARGEST_POINTER and file.read_bytes().startswith(_POINTER):
                found.append(file.relative_to(root).as_posix())
    except (OSError, ConfigurationError):
        return found  # whoever loads the entry says what is wrong there
    return found


def what_is_missing(root: Path) -> str:
    """Which large files of a checkout are not there, as a clause; "" where all are. `FETCH` is the remedy."""
    files = pointers(root)
    more = f" and {len(files) - 1} more" if len(files) > 1 else ""
    return f"{files[0]!r}{more} is not there: git lfs has left a pointer in its place" if files else ""


def missing_from(agent: str) -> str:
    """The same for an agent by its name or path; "" for one that is no entry, or none that can be found."""
    from airhockey.agents.packaging.checkout import find_checkout
    from airhockey.agents.submission import is_submission

    try:
        return what_is_missing(find_checkout(Path(agent).expanduser()).root) if is_submission(agent) else ""
    except (OSError, ConfigurationError):
        return ""  # whoever builds it says what is wrong there
