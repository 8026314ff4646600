"""NumPy's own random functions, callable from compiled code: what a `Generator` draws there is what it would draw in Python.

NumPy's library is asked for the functions' addresses (see `airhockey.envs.kernel.engine`); a generator is the address of its
state, which both sides advance.
"""

import ctypes
from typing import Any

import llvmlite.binding
import numba
import numpy as np
from numba.core import types
from numba.extending import intrinsic

from airhockey.envs.vector.compiling import compiled
from airhockey.errors import SimulationError

_NAMES = ("random_standard_normal_fill", "random_standard_uniform", "random_bounded_uint64_fill")


def _register() -> None:
    library = ctypes.CDLL(np.random._generator.__file__)
    for name in _NAMES:
        if not hasattr(library, name):
            raise SimulationError(
                f"NumPy {np.__version__} does not offer {name} to compiled code; install another version"
            )
        llvmlite.binding.add_symbol(f"airhockey_{name}", ctypes.cast(getattr(library, name), ctypes.c_void_p).value)


_register()
_normal_fill: Any = numba.types.ExternalFunction(
    "airhockey_random_standard_normal_fill", types.void(types.intp, types.intp, types.intp)
)
_uniform: Any = numba.types.ExternalFunction("airhockey_random_standard_uniform", types.float64(types.intp))
_bounded_fill: Any = numba.types.ExternalFunction(
    "airhockey_random_bounded_uint64_fill",
    types.void(types.intp, types.uint64, types.uint64, types.intp, types.boolean, types.intp),
)


def address_of(generator: np.random.Generator) -> int:
    """Where compiled code finds a generator, which the caller keeps alive."""
    return int(generator.bit_generator.ctypes.bit_generator.value)


@intrinsic
def _data(typing_context: Any, array: Any) -> Any:
    """The address of an array's first entry."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        made = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.ptrtoint(made.data, context.get_value_type(types.intp))

    return types.intp(array), generate


@compiled
def standard_normal(generator: int, values: Any) -> None:
    """`values[...] = generator.standard_normal(values.shape)`, for values that stand one after the other."""
    _normal_fill(generator, values.size, _data(values))


@compiled
def uniform(generator: int) -> float:
    """`generator.random()`."""
    return float(_uniform(generator))


@compiled
def integer(generator: int, low: int, high: int, scratch: Any) -> Any:
    """`generator.integers(low, high + 1)`; `scratch` is an array of unsigned integers. Shape (1,)."""
    _bounded_fill(generator, np.uint64(low), np.uint64(high - low), 1, False, _data(scratch))
    return np.int64(scratch[0])
