"""Kinematics of a robot by MuJoCo; `link` is "1" … "7", or "ee" for the end-effector. All in the robot frame."""

from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
_DAMPING, _LONGEST_STEP, _TOLERANCE, _ITERATIONS = 1e-3, 0.1, 1e-4, 1000
_MIDDLE = 0.95  # of the joint range


def forward_kinematics(mj_model: Any, mj_data: Any, q: ArrayLike, link: str = "ee") -> tuple[Array, Array]:
    """Position [m] and rotation matrix of a link. Shapes (3,), (3, 3)."""
    body = _at(mj_model, mj_data, q, link)
    return mj_data.xpos[body].copy(), mj_data.xmat[body].reshape(3, 3).copy()


def jacobian(mj_model: Any, mj_data: Any, q: ArrayLike, link: str = "ee") -> Array:
    """Jacobian of a link's position (rows 0–2) and orientation (rows 3–5). Shape (6, n)."""
    body = _at(mj_model, mj_data, q, link)
    result = np.empty((6, mj_model.nv))
    mujoco.mj_jac(mj_model, mj_data, result[:3], result[3:], mj_data.xpos[body], body)
    return result


def inverse_kinematics(
    mj_model: Any,
    mj_data: Any,
    desired_position: ArrayLike,
    desired_rotation: ArrayLike | None = None,
    initial_q: ArrayLike | None = None,
    link: str = "ee",
) -> tuple[bool, Array]:
    """Joints that bring a link to a pose, by damped least squares (challenge page, section 4).

    Args:
        mj_model, mj_data: Of the robot.
        desired_position: In [m]. Shape (3,), or (2,) for a planar robot.
        desired_rotation: Rotation matrix; None where it does not matter. Shape (3, 3).
        initial_q: Where to begin; default: zero. Shape (n,).
        link: "1" … "7" or "ee".

    Returns:
        Whether it was reached, and the joints. Shape (n,).
    """
    position = np.asarray(desired_position, dtype=np.float64)
    rotation = None if desired_rotation is None else np.asarray(desired_rotation, dtype=np.float64).reshape(3, 3)
    q = np.zeros(mj_model.nq) if initial_q is None else np.array(initial_q, dtype=np.float64)
    middle, half = mj_model.jnt_range.mean(axis=1), 0.5 * _MIDDLE * np.ptp(mj_model.jnt_range, axis=1)
    rows = [*range(position.size), *(range(3, 6) if rotation is not None else ())]
    for _ in range(_ITERATIONS):
        reached, turned = forward_kinematics(mj_model, mj_data, q, link)
        error = position - reached[: position.size]
        if rotation is not None:
            error = np.concatenate((error, _turn(rotation @ turned.T)))
        if np.linalg.norm(error) < _TOLERANCE:
            return True, q
        slope = jacobian(mj_model, mj_data, q, link)[rows]
        step = np.linalg.solve(slope.T @ slope + _DAMPING * np.eye(q.size), slope.T @ error)
        length = float(np.linalg.norm(step))
        if length > _LONGEST_STEP:
            step *= _LONGEST_STEP / length
        q = np.clip(q + step, middle - half, middle + half)
    return False, q


def link_to_xml_name(mj_model: Any, link: str) -> str:
    """The name of a link's body."""
    names = (
        {**{str(k): f"planar_robot_1/body_{k}" for k in range(1, 4)}, "ee": "planar_robot_1/body_ee"}
        if mj_model.nq == 3
        else {**{str(k): f"iiwa_1/link_{k}" for k in range(1, 8)}, "ee": "iiwa_1/striker_joint_link"}
    )
    if link not in names:
        raise ValueError(f"unknown link {link!r}; there are {', '.join(names)}")
    return names[link]


def _at(mj_model: Any, mj_data: Any, q: ArrayLike, link: str) -> int:
    """Put the robot there; gives the number of the link's body."""
    joints = np.asarray(q, dtype=np.float64)
    mj_data.qpos[: joints.size] = joints
    mujoco.mj_fwdPosition(mj_model, mj_data)
    return int(mj_model.body(link_to_xml_name(mj_model, link)).id)


def _turn(rotation: Array) -> Array:
    """A rotation as a vector: its axis, as long as its angle in [rad]. Shape (3,)."""
    quaternion, vector = np.empty(4), np.empty(3)
    mujoco.mju_mat2Quat(quaternion, rotation.flatten())
    mujoco.mju_quat2Vel(vector, quaternion, 1.0)
    return vector
