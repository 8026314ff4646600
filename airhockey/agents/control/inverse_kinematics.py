"""Inverse kinematics: a joint position whose rod tip is at a point of the table."""

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.control.kinematics import ArmKinematics

Array = NDArray[np.float64]

DAMPING = 1e-6
"""Added to J Jᵀ, in [m²]/[rad²]: keeps steps finite near singular postures."""


def inverse_kinematics(
    kinematics: ArmKinematics,
    target: Array,
    initial: Array,
    share: float = 0.92,
    tolerance: float = 1e-5,
    iterations: int = 60,
) -> Array | None:
    """The joint position near an initial one that brings the rod tip to a target.

    Damped Gauss–Newton steps Δq = Jᵀ(JJᵀ + λI)⁻¹e, limited in length, within a share of the joint range.

    Args:
        kinematics: Of the robot.
        target: In the robot frame, in [m]; its z is not looked at on the planar robot. Shape (3,).
        initial: In [rad]. Shape (n,).
        share: Of the joint range that may be used.
        tolerance: Largest remaining distance, in [m].
        iterations: At most so many steps.

    Returns:
        In [rad], shape (n,); None where the target is out of reach.
    """
    m = kinematics.n_coordinates
    lower, upper = share * kinematics.spec.joint_position_limit
    q = np.clip(initial, lower, upper)
    for _ in range(iterations):
        position, jacobian = kinematics.position_and_jacobian(q)
        error = (target - position)[:m]
        if float(error @ error) < tolerance**2:
            return q
        j = jacobian[:m]
        step = j.T @ np.linalg.solve(j @ j.T + DAMPING * np.eye(m), error)
        length = float(np.linalg.norm(step))
        q = np.clip(q + step * min(1.0, 0.5 / max(length, 1e-12)), lower, upper)
    return None
