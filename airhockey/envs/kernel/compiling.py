"""One decorator, so that every compiled function is compiled in the same way."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """Compile with numba: without the interpreter lock (threads scale), cached on disk (a second start is quick).

    Reference counting (`_nrt`) is off: passing named tuples of arrays between functions would count for a tenth of a step.
    So compiled code allocates no arrays and returns none; it writes to those it is given.
    Fast-math stays off: it would let the compiler reorder sums, and results must not depend on the machine's vector width.
    """
    return cast(Function, numba.njit(nogil=True, cache=True, error_model="numpy", _nrt=False)(function))
