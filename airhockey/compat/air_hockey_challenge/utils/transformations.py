"""Between the frame of a robot and the world."""

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def robot_to_world(
    base_frame: ArrayLike, translation: ArrayLike, rotation: ArrayLike | None = None
) -> tuple[Array, Array]:
    """A pose given in the robot frame, in the world.

    Args:
        base_frame: One of `env_info["robot"]["base_frame"]`. Shape (4, 4).
        translation: In [m]. Shape (3,), or (2,) on the table.
        rotation: Rotation matrix (3, 3), quaternion w, x, y, z (4,), or None.

    Returns:
        Position and rotation matrix. Shapes (3,), (3, 3).
    """
    frame = np.asarray(base_frame, dtype=np.float64) @ _frame(translation, rotation)
    return frame[:3, 3], frame[:3, :3]


def world_to_robot(
    base_frame: ArrayLike, translation: ArrayLike, rotation: ArrayLike | None = None
) -> tuple[Array, Array]:
    """A pose given in the world, in the robot frame; see `robot_to_world`."""
    frame = np.linalg.inv(np.asarray(base_frame, dtype=np.float64)) @ _frame(translation, rotation)
    return frame[:3, 3], frame[:3, :3]


def _frame(translation: ArrayLike, rotation: ArrayLike | None) -> Array:
    frame = np.eye(4)
    position = np.asarray(translation, dtype=np.float64)
    frame[: position.size, 3] = position
    if rotation is not None:
        turned = np.asarray(rotation, dtype=np.float64)
        if turned.size == 4:
            matrix = np.empty(9)
            mujoco.mju_quat2Mat(matrix, turned.reshape(4))
            turned = matrix
        frame[:3, :3] = turned.reshape(3, 3)
    return frame
