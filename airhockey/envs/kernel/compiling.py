"""One decorator, so that every compiled function is compiled in the same way."""

import hashlib
import os
import pathlib
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])

_FOLDER = pathlib.Path(__file__).parent


def _cache_folder() -> str:
    """Where compiled code is kept: a folder named after all the sources that it is made of, constants included.

    Numba notices that a function's own file has changed, but not that one which it calls has, and would run the old code in
    silence: after an update of the package, too.
    """
    sources = [*sorted(_FOLDER.glob("*.py")), _FOLDER.parent / "specs.py"]
    fingerprint = hashlib.sha256(b"\0".join(source.read_bytes() for source in sources)).hexdigest()[:16]
    if numba.config.CACHE_DIR:
        place = pathlib.Path(numba.config.CACHE_DIR)
    elif os.access(_FOLDER, os.W_OK):
        place = _FOLDER / "__pycache__"
    else:
        place = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / "airhockey"
    return str(place / f"compiled-{fingerprint}")


_CACHE_FOLDER = _cache_folder()


def compiled(function: Function) -> Function:
    """Compile with numba: without the interpreter lock (threads scale), cached on disk (a second start is quick).

    Reference counting (`_nrt`) is off: passing named tuples of arrays between functions would count for a tenth of a step.
    So compiled code allocates no arrays and returns none; it writes to those it is given.
    Fast-math stays off: it would let the compiler reorder sums, and results must not depend on the machine's vector width.
    """
    before, numba.config.CACHE_DIR = numba.config.CACHE_DIR, _CACHE_FOLDER
    try:
        return cast(Function, numba.njit(nogil=True, cache=True, error_model="numpy", _nrt=False)(function))
    finally:
        numba.config.CACHE_DIR = before
