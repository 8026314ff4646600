"""What an action means: a velocity of the rod tip, the two directions in which a player thinks, or of every joint.

The tip's acceleration follows the velocity asked for; the pseudo-inverse turns it into joint accelerations that keep the
height, and the null space returns to the start posture. All of this is the policy's part: whatever comes out is projected
onto the tangent space afterwards. An action of 0 comes to rest and stays.
"""

from math import hypot, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.atacom.chain import TaskMotion, Z
from airhockey.agents.atacom.parameters import AtacomParameters
from airhockey.agents.compiling import compiled
from airhockey.agents.small_matrices import factor, product, solve_backward, solve_forward
from airhockey.envs.specs import RobotSpec

Array = NDArray[np.float64]

_DAMPING = 1e-4
"""Added to J W⁻¹ Jᵀ, in [m²]/[s⁴]: finite near singular postures."""


class Gains(NamedTuple):
    """How tip and joints follow.

    Attributes:
        speed: At an action of 1, in [m]/[s].
        time: In which it is taken up, in [s].
        acceleration: At most, in [m]/[s²].
        height: That the tip keeps, in [m].
        height_gain, posture_gain: Stiffnesses, in [1/s²].
        posture: That the null space returns to, in [rad]. Shape (n,).
        joint_velocity: At an action of 1, in [rad]/[s]. Shape (n,).
        joint_acceleration: At |u| = 1, in [rad]/[s²]. Shape (n,).
    """

    speed: float
    time: float
    acceleration: float
    height: float
    height_gain: float
    posture_gain: float
    posture: Array
    joint_velocity: Array
    joint_acceleration: Array


def gains_of(spec: RobotSpec, p: AtacomParameters) -> Gains:
    """The gains for a robot."""
    return Gains(
        p.tip_speed, p.follow_time, p.tip_acceleration, spec.desired_height, p.height_gain, p.posture_gain,
        np.array(spec.start), p.joint_speed * spec.joint_velocity_limit[1],
        p.acceleration_share * spec.joint_acceleration_limit[1],
    )  # fmt: skip


@compiled
def action_of_joints(wanted: Array, gains: Gains, velocity: Array) -> Array:
    """The action that gives the joints velocities, in units of `gains.joint_velocity`. Shape (n,)."""
    action = (gains.joint_velocity * wanted - velocity) / (gains.time * gains.joint_acceleration)
    return np.minimum(np.maximum(action, -1.0), 1.0)


@compiled
def action_of_tip(wanted: Array, gains: Gains, task: TaskMotion, q: Array, velocity: Array) -> Array:
    """The action of the joints that gives the tip a velocity.

    Args:
        wanted: Velocity of the tip, in units of `gains.speed`, in the robot frame. Shape (2,).
        gains: How it follows.
        task: Of the tip and the links.
        q, velocity: Joint command. Shapes (n,), (n,).

    Returns:
        In units of the joints' largest accelerations, each entry within [−1, 1]. Shape (n,).
    """
    values, rows, drift = task
    m = 3 if values.size > 2 else 2
    present = product(rows[:m], velocity)
    asked = np.empty(m)
    asked[:2] = (gains.speed * wanted - present[:2]) / gains.time
    asked[:2] *= min(1.0, gains.acceleration / max(hypot(asked[0], asked[1]), 1e-9))
    if m == 3:
        asked[2] = gains.height_gain * (gains.height - values[Z]) - 2.0 * sqrt(gains.height_gain) * present[2]
    free = gains.posture_gain * (gains.posture - q) - 2.0 * sqrt(gains.posture_gain) * velocity
    scaled = rows[:m] * gains.joint_acceleration  # per unit of action
    gram = _DAMPING * np.eye(m)
    for i in range(m):
        for k in range(m):
            for j in range(q.size):
                gram[i, k] += scaled[i, j] * scaled[k, j]
    rest = asked - drift[:m] - product(rows[:m], free)
    factor(gram)
    solve_forward(gram, rest)
    solve_backward(gram, rest)
    action = free / gains.joint_acceleration
    for i in range(m):
        action += scaled[i] * rest[i]
    action /= max(1.0, np.max(np.abs(action)))
    return action
