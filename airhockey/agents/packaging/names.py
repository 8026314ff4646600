"""Which file names a submission may have: those that mean the same file on every machine."""

import unicodedata
from collections.abc import Iterable

from airhockey.errors import ConfigurationError

MAX_NAME = 200
"""Longest path inside a submission, in characters."""

_DEVICES = frozenset(("con", "prn", "aux", "nul", *(f"{kind}{k}" for kind in ("com", "lpt") for k in range(1, 10))))


def name_problem(name: str) -> str | None:
    """What is wrong with the path of a file inside a submission, in words; None if nothing is.

    Args:
        name: Relative path with forward slashes.
    """
    parts = name.split("/")
    if not name or "" in parts:
        return "is empty or has an empty part" if not name.startswith("/") else "is absolute"
    if ".." in parts or "." in parts:
        return "climbs out of the submission or walks on the spot ('..', '.')"
    if "\\" in name or (len(parts[0]) == 2 and parts[0][1] == ":"):
        return "is a path of Windows"
    if ":" in name or any(part.split(".")[0].lower() in _DEVICES for part in parts):
        return "is a device or a stream on Windows"
    if any(unicodedata.category(letter) in ("Cc", "Cs", "Co", "Cn") for letter in name):
        return "is not UTF-8 text"
    if any(unicodedata.category(letter) in ("Cf", "Zl", "Zp") for letter in name):
        return "has letters that nobody sees or that turn a line around"
    if unicodedata.normalize("NFC", name) != name:
        return "has letters in decomposed form (NFC is needed)"
    if len(name) > MAX_NAME:
        return f"is longer than {MAX_NAME} characters"
    return None


def check_names(names: Iterable[str]) -> None:
    """Refuse names that mean different files on different machines.

    Raises:
        ConfigurationError: A name is not usable, or two differ in upper and lower case only, or not at all.
    """
    seen: dict[str, str] = {}
    for name in names:
        problem = name_problem(name)
        if problem is not None:
            raise ConfigurationError(f"the file name {name!a} {problem}; rename the file and pack again")
        twin = seen.setdefault(name.casefold(), name)
        if twin is not name:
            raise ConfigurationError(f"the file names {name!r} and {twin!r} are the same on some machines; rename one")
