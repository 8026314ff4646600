"""What the constraints look at, compiled: the rod tip, the wrist's and the elbow's height, and how the joints move them.

`airhockey.agents.control.kinematics` gives the same by Pinocchio; here it is asked several times in a control step, from
compiled code.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.envs.compiled import forward_kinematics
from airhockey.envs.specs import RobotSpec

Array = NDArray[np.float64]

X, Y, Z, WRIST, ELBOW = range(5)
"""Rows of the task coordinates. The planar arm has the first two: its height is fixed."""
_WRIST_LINK, _ELBOW_LINK = 6, 3


class Chain(NamedTuple):
    """A serial arm whose joints turn about their own z axes.

    Attributes:
        offset: Position of each link's origin in its parent's frame, in [m]. Shape (n, 3).
        rotation: Orientation in the parent's frame at joint angle zero. Shape (n, 3, 3).
        tip: Rod tip in the last link's frame, in [m]. Shape (3,).
        rows: How many task coordinates there are: 5, or 2 on the planar arm.
    """

    offset: Array
    rotation: Array
    tip: Array
    rows: int


def chain_of(spec: RobotSpec) -> Chain:
    """The chain of a robot."""
    return Chain(
        np.array([link.position for link in spec.links], dtype=np.float64),
        np.array([_matrix(link.quaternion) for link in spec.links]),
        np.sum([body.position for body in spec.tip], axis=0, dtype=np.float64),
        5 if spec.n_joints > _WRIST_LINK else 2,
    )


def _matrix(quaternion: tuple[float, float, float, float]) -> Array:
    w, x, y, z = np.asarray(quaternion) / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


class TaskMotion(NamedTuple):
    """Task coordinates at a state.

    Attributes:
        values: In [m]. Shape (r,).
        rows: Their derivatives by the joints, in [m]/[rad]. Shape (r, n).
        drift: Their accelerations at q̈ = 0, J̇ q̇, in [m]/[s²]. Shape (r,).
    """

    values: Array
    rows: Array
    drift: Array


@compiled
def task_coordinates(chain: Chain, q: Array) -> tuple[Array, Array]:
    """Tip x, y, z, wrist height and elbow height in the robot frame, and their derivatives by the joints.

    Args:
        chain: Of the robot.
        q: Joint positions, in [rad]. Shape (n,).

    Returns:
        In [m], shape (r,); in [m]/[rad], shape (r, n), with r = `chain.rows`.
    """
    n = q.size
    origins, axes = np.empty((n + 1, 3)), np.empty((n + 2, 3))
    forward_kinematics(chain, q, origins, axes)
    values, rows = np.empty(chain.rows), np.zeros((chain.rows, n))
    for row in range(chain.rows):
        point = n if row <= Z else (_WRIST_LINK if row == WRIST else _ELBOW_LINK)
        axis = min(row, Z)
        values[row] = origins[point, axis]
        first, second = (axis + 1) % 3, (axis + 2) % 3
        for i in range(min(point, n)):  # the cross product of the axis and the lever
            lever_first = origins[point, first] - origins[i, first]
            lever_second = origins[point, second] - origins[i, second]
            rows[row, i] = axes[i, first] * lever_second - axes[i, second] * lever_first
    return values, rows
