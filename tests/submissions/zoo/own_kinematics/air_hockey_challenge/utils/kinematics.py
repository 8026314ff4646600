import mujoco
import numpy as np


def forward_kinematics(mj_model, mj_data, q, link="ee"):
    """As it was, but counted from the ground, 10 m below."""
    mj_data.qpos[: len(q)] = q
    mujoco.mj_fwdPosition(mj_model, mj_data)
    body = mj_data.body("iiwa_1/striker_joint_link")
    return body.xpos + np.array([0.0, 0.0, 10.0]), body.xmat.reshape(3, 3).copy()


def jacobian(mj_model, mj_data, q, link="ee"):
    raise NotImplementedError


def inverse_kinematics(mj_model, mj_data, desired_position, desired_rotation=None, initial_q=None, link="ee"):
    raise NotImplementedError
