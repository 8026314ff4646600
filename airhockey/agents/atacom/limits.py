"""The challenge's constraints as ATACOM needs them: rows k(q) ≤ 0 with margins, units and softness."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.atacom.chain import ELBOW, WRIST, X, Y, Z
from airhockey.agents.atacom.parameters import AtacomParameters
from airhockey.envs.specs import MALLET, TABLE, RobotSpec

Array = NDArray[np.float64]


class Limits(NamedTuple):
    """Bounds on task coordinates (one row each) and on joints (both sides each).

    A task row says sign · (coordinate − bound) ≤ 0.

    Attributes:
        coordinate: Which task coordinate a row bounds (`chain.X` …). Shape (k,), integers.
        sign: 1 for an upper bound, −1 for a lower one. Shape (k,).
        bound: In [m]. Shape (k,).
        time: K_f of the viability form, in [s]. Shape (k,).
        softness: 1/β, in [m]. Shape (k,).
        position, velocity: Joint bounds, in [rad] and [rad]/[s]. Shapes (2, n), (2, n).
        joint_time: K_f of the joint positions, in [s].
        joint_softness: In [rad].
        velocity_softness: In [rad]/[s]. Shape (n,).
        acceleration: Joint acceleration at |u| = 1, in [rad]/[s²]. Shape (n,).
        tip_acceleration: Nominal acceleration of a task coordinate at |u| = 1, in [m]/[s²].
        contraction: λ, in [1/s].
    """

    coordinate: NDArray[np.int64]
    sign: Array
    bound: Array
    time: Array
    softness: Array
    position: Array
    velocity: Array
    joint_time: float
    joint_softness: float
    velocity_softness: Array
    acceleration: Array
    tip_acceleration: float
    contraction: float


def limits_of(spec: RobotSpec, p: AtacomParameters) -> Limits:
    """The challenge's constraints (section 5) for a robot, less margins for the tracking error."""
    near_x = -spec.base_positions[0][0] - TABLE.length / 2 + MALLET.radius + p.edge_margin
    side = TABLE.width / 2 - MALLET.radius - p.edge_margin
    rows = [
        (X, -1.0, near_x, p.edge_time, p.edge_softness),
        (Y, -1.0, -side, p.edge_time, p.edge_softness),
        (Y, 1.0, side, p.edge_time, p.edge_softness),
    ]
    if spec.n_joints == 7:
        low, high = spec.desired_height - p.height_tolerance, spec.desired_height + p.height_tolerance
        rows += [(Z, -1.0, low, p.height_time, p.height_softness), (Z, 1.0, high, p.height_time, p.height_softness)]
        rows += [(row, -1.0, p.link_height, p.link_time, p.link_softness) for row in (WRIST, ELBOW)]
    coordinate, sign, bound, time, softness = (np.array(column) for column in zip(*rows, strict=True))
    velocity = p.velocity_share * spec.joint_velocity_limit
    return Limits(
        coordinate.astype(np.int64), sign, bound, time, softness,
        p.position_share * spec.joint_position_limit, velocity, p.joint_time, p.joint_softness,
        p.velocity_softness * velocity[1], p.acceleration_share * spec.joint_acceleration_limit[1],
        p.tip_acceleration, p.contraction,
    )  # fmt: skip
