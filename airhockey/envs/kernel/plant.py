"""The simulated plant as compiled code sees it: addresses for MuJoCo's functions and views of its arrays."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Geometry(NamedTuple):
    """Where things are in MuJoCo's arrays and in the world.

    Robot r's joints, and its motors, start at r · `stride`; the puck's three joints are the last ones. Body `tips[r]` is its
    end-effector; its base stands at (`base_x[r]`, 0, `base_z`), turned by 180° where `sides[r]` is -1.
    """

    model: int
    data: int
    tips: NDArray[np.int64]
    sides: Array
    base_x: Array
    base_z: float
    stride: int


class Plant(NamedTuple):
    """`Geometry` with MuJoCo's own arrays (never copies)."""

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
