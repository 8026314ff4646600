"""The simulated plant as compiled code sees it: addresses for MuJoCo's functions and views of its arrays."""

from typing import Any, NamedTuple

import numpy as np
from numba.core import cgutils, types
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array
from numpy.typing import NDArray

from airhockey.envs.kernel.compiling import compiled

Array = NDArray[np.float64]


class Addresses(NamedTuple):
    """Where MuJoCo's objects and the arrays of its data lie, good for this process and as long as the objects live.

    An array that is given to compiled code costs 0.1 µs a call, so it makes its views itself.
    """

    model: int
    data: int
    ctrl_address: int
    qpos_address: int
    qvel_address: int
    xpos_address: int
    warnings_address: int


class Geometry(NamedTuple):
    """Where things are in MuJoCo's arrays and in the world, and how long those arrays are.

    Robot r's joints, and its motors, start at r · `stride`; the puck's three joints are the last ones. Body `tips[r]` is its
    end-effector; its base stands at (`base_x[r]`, 0, `base_z`), turned by 180° where `sides[r]` is -1. MuJoCo's counts of
    warnings are `warning_stride` integers apart.
    """

    tips: NDArray[np.int64]
    sides: Array
    base_x: Array
    base_z: float
    stride: int
    n_motors: int
    n_joints: int
    n_bodies: int
    n_warnings: int
    warning_stride: int


class Plant(NamedTuple):
    """What the control step uses of both, with MuJoCo's own arrays (never copies)."""

    model: int
    data: int
    ctrl: Array
    qpos: Array
    qvel: Array
    xpos: Array
    tips: NDArray[np.int64]
    sides: Array
    base_x: Array
    base_z: float
    stride: int


def addresses_of(model: Any, data: Any) -> Addresses:
    """The addresses of a model and its data, which the caller keeps alive."""
    arrays = (data.ctrl, data.qpos, data.qvel, data.xpos, data.warning.number)
    return Addresses(model._address, data._address, *(array.ctypes.data for array in arrays))


@intrinsic
def _view(typing_context: Any, address: Any, kind: Any, shape: Any) -> Any:
    """The array at an address: of numbers of the same type as `kind`, in rows of the C order, of a shape given as a tuple.

    Numba's own `carray` returns an array from a function of its own, which needs reference counts.
    """
    array = types.Array(kind, len(shape), "C")

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        made = context.make_array(array)(context, builder)
        item_size = context.get_abi_sizeof(context.get_data_type(kind))
        strides = [context.get_constant(types.intp, item_size)]
        sizes = cgutils.unpack_tuple(builder, arguments[2])
        for size in sizes[:0:-1]:
            strides.insert(0, builder.mul(strides[0], size))
        populate_array(
            made,
            data=builder.inttoptr(arguments[0], made.data.type),
            shape=sizes,
            strides=strides,
            itemsize=context.get_constant(types.intp, item_size),
            meminfo=None,
        )
        return made._getvalue()

    return array(address, kind, shape), generate


@compiled
def plant_of(m: Any) -> Plant:
    """The plant from the simulation's record, which has the fields of `Addresses` and `Geometry`."""
    return Plant(
        m.model,
        m.data,
        _view(m.ctrl_address, 0.0, (m.n_motors,)),
        _view(m.qpos_address, 0.0, (m.n_joints,)),
        _view(m.qvel_address, 0.0, (m.n_joints,)),
        _view(m.xpos_address, 0.0, (m.n_bodies, 3)),
        m.tips,
        m.sides,
        m.base_x,
        m.base_z,
        m.stride,
    )


@compiled
def warned(m: Any) -> bool:
    """Whether MuJoCo has warned of anything since the last reset."""
    counts = _view(m.warnings_address, np.int32(0), (m.n_warnings * m.warning_stride,))
    happened = False
    for k in range(m.n_warnings):
        happened = happened or counts[k * m.warning_stride] != 0
    return happened
