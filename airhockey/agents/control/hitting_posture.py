"""The posture from which the rod tip can move fastest in a direction, at a given point.

    maximise ‖dᵀ J(q)‖²   subject to   x(q) = x_hit and the joint limits

(Liu et al., IROS 2021), by projected gradient: an ascent step in the null space of J, then inverse kinematics back to
the point. It is offered to players; those of the package hit without.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.control.inverse_kinematics import inverse_kinematics
from airhockey.agents.control.kinematics import ArmKinematics
from airhockey.agents.control.speed_limit import largest_speed

Array = NDArray[np.float64]

FIRST_STEP = 0.3
"""Length of an ascent step at first, in [rad]."""


@dataclass(frozen=True)
class HittingPosture:
    """A joint position [rad], shape (n,), and the largest tip speed [m]/[s] along the hitting direction there."""

    q: Array
    speed: float


def hitting_posture(
    kinematics: ArmKinematics,
    point: Array,
    direction: Array,
    initial: Array,
    velocity_limit: Array,
    iterations: int = 20,
) -> HittingPosture | None:
    """The best posture found, starting from a present one.

    Args:
        kinematics: Of the robot.
        point: x_hit in the robot frame, in [m]. Shape (3,).
        direction: Unit vector d in the plane. Shape (2,).
        initial: Warm start, in [rad]. Shape (n,).
        velocity_limit: Lower and upper joint velocities, in [rad]/[s]. Shape (2, n).
        iterations: Ascent steps; each costs about 0.1 ms.

    Returns:
        The posture, or None where the point is out of reach.
    """
    m, step = kinematics.n_coordinates, FIRST_STEP
    d = np.zeros(m)
    d[:2] = direction
    q = inverse_kinematics(kinematics, point, initial)
    if q is None:
        return None
    value = _manipulability(kinematics, q, d)
    for _ in range(iterations if kinematics.n_joints > m else 0):
        jacobian = kinematics.jacobian(q)[:m]
        gradient = _gradient(kinematics, q, d)
        basis = np.linalg.svd(jacobian)[2][m:]
        ascent = basis.T @ (basis @ gradient)
        length = float(np.linalg.norm(ascent))
        if length < 1e-9 or step < 1e-3:
            break
        moved = inverse_kinematics(kinematics, point, q + ascent * (step / length), iterations=10)
        better = None if moved is None else _manipulability(kinematics, moved, d)
        if moved is not None and better is not None and better > value:
            q, value = moved, better
        else:
            step *= 0.5
    return HittingPosture(q, largest_speed(kinematics.jacobian(q)[:m], d, velocity_limit[0], velocity_limit[1]))


def _manipulability(kinematics: ArmKinematics, q: Array, d: Array) -> float:
    row = d @ kinematics.jacobian(q)[: len(d)]
    return float(row @ row)


def _gradient(kinematics: ArmKinematics, q: Array, d: Array, h: float = 1e-5) -> Array:
    """Forward differences of ‖dᵀJ(q)‖². Shape (n,)."""
    here = _manipulability(kinematics, q, d)
    moved = np.tile(q, (len(q), 1)) + h * np.eye(len(q))
    return np.array([_manipulability(kinematics, row, d) - here for row in moved]) / h
