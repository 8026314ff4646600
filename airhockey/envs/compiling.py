"""Compiling with numba so that what is cached on disk is never older than its sources.

Numba notices that a function's own file has changed, but not that one which it calls has, and would run the old code in
silence: after an edit, or after an update of the package. So each group of modules keeps its compiled code in a folder named
after all the sources that it is made of, constants included.
"""

import functools
import hashlib
import os
import pathlib
import sys
import tempfile
from collections.abc import Callable, Iterable
from typing import Any, TypeVar, cast

import numba
from numba.core import caching

from airhockey.errors import EnvironmentFault
from airhockey.inputs.temporary_folders import temporary_folder

_PASSING = "AIRHOCKEY_PASSING_CACHE"
"""Names the folder for compiled code that the parent made, where none can be written that stays."""
Function = TypeVar("Function", bound=Callable[..., Any])


def compiler(home: pathlib.Path, sources: Iterable[pathlib.Path], **options: Any) -> Callable[[Function], Function]:
    """A decorator that compiles a group's functions without the interpreter lock, cached on disk.

    Args:
        home: Folder of the group; the cache is in its `__pycache__`, or in the user's cache where that is not writable.
        sources: Every file that the group's compiled code is made of.
        options: More options of `numba.njit`.

    Raises:
        EnvironmentFault: The compiler is disabled.
    """
    if numba.config.DISABLE_JIT:
        raise EnvironmentFault(
            "numba's compiler is disabled, and nothing can be simulated without: unset NUMBA_DISABLE_JIT"
        )
    cache = cache_folder(home, sources)

    def compiled(function: Function) -> Function:
        before, numba.config.CACHE_DIR = numba.config.CACHE_DIR, cache
        try:
            return cast(Function, numba.njit(nogil=True, cache=True, **options)(function))
        finally:
            numba.config.CACHE_DIR = before

    return compiled


def cache_folder(home: pathlib.Path, sources: Iterable[pathlib.Path]) -> str:
    """Where the compiled code of a group is kept; see `compiler`."""
    name = f"compiled-{_fingerprint(tuple(sorted(sources)))}"
    if numba.config.CACHE_DIR:
        return str(pathlib.Path(numba.config.CACHE_DIR) / name)
    beside = home / "__pycache__" / name
    # An isolated agent cannot write there, but its numba was told how to use what others left (`isolation.numba_cache`).
    reads_only = "ReadOnlyCache" in os.environ.get("NUMBA_CACHE_LOCATOR_CLASSES", "")
    if os.access(home, os.W_OK) or (reads_only and beside.is_dir()):
        return str(beside)
    own = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / "airhockey" / name
    return str(own) if _can_write(own) else str(pathlib.Path(_passing_cache()) / name)


@functools.cache
def _fingerprint(sources: tuple[pathlib.Path, ...]) -> str:
    """Of what the sources were when this process first asked: several decorators of a group ask, at every start."""
    return hashlib.sha256(b"\0".join(source.read_bytes() for source in sources)).hexdigest()[:16]


def is_kept() -> bool:
    """Whether other processes will find what is compiled here."""
    return _PASSING not in os.environ


def _can_write(folder: pathlib.Path) -> bool:
    """Whether files can be written there, perhaps once it is made."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except (OSError, RuntimeError):
        return False


@functools.cache
def _passing_cache() -> str:
    """A folder for this process and its children, where none can be written that stays; says once that this is slow."""
    folder = os.environ.get(_PASSING)
    if folder is None:
        folder = os.environ[_PASSING] = str(temporary_folder("compiled"))
        print(
            "hockey: no folder for compiled code can be written: it is compiled anew each time, which takes a minute "
            "(XDG_CACHE_HOME names a folder)",
            file=sys.stderr,
        )
    return folder


def _save_if_possible(self: Any, key: Any, data: Any) -> None:
    """Compiled code that cannot be kept is used all the same; numba itself would let the call fail that was compiled for."""
    try:
        _save(self, key, data)
    except OSError as error:
        _say_that_nothing_is_kept(error.strerror or str(error))


@functools.cache
def _say_that_nothing_is_kept(why: str) -> None:
    print(
        f"hockey: compiled code cannot be kept ({why}): it will be compiled anew, which takes a minute", file=sys.stderr
    )


_save = caching.IndexDataCacheFile.save
caching.IndexDataCacheFile.save = _save_if_possible
