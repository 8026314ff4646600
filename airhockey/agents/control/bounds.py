"""How fast each joint may move now, so that it can always stop before its limits."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.control.braking import joint_speeds
from airhockey.envs.specs import RobotSpec

Array = NDArray[np.float64]


@dataclass(frozen=True)
class JointBounds:
    """Velocity bounds of the joints from the limits on position, velocity and acceleration.

    Attributes:
        position: Lower and upper positions to keep, in [rad]. Shape (2, n).
        velocity: Lower and upper velocities to keep, in [rad]/[s]. Shape (2, n).
        acceleration: Largest change of velocity per second, in [rad]/[s²]. Shape (n,).
        dt: Length of a control step, in [s].
    """

    position: Array
    velocity: Array
    acceleration: Array
    dt: float

    @classmethod
    def of(
        cls, spec: RobotSpec, position_share: float, velocity_share: float, acceleration_share: float, dt: float
    ) -> "JointBounds":
        """Shares of a robot's own limits.

        Args:
            spec: The robot.
            position_share, velocity_share: Below 0.95, where the constraints begin.
            acceleration_share: Below 1.
            dt: Length of a control step, in [s].
        """
        return cls(
            position_share * spec.joint_position_limit,
            velocity_share * spec.joint_velocity_limit,
            acceleration_share * spec.joint_acceleration_limit[1],
            dt,
        )

    def velocities(self, q: Array, velocity: Array) -> Array:
        """Lower and upper velocity at the end of the coming step.

        A joint at distance d from its limit, after moving on with its present velocity for half a step (equation
        4.1 of the thesis), may end the step with the v that still stops in time: v²/(2a) + v Δt = d. The bounds
        never contradict the acceleration limit: a joint that is too fast is asked for the strongest braking.

        Args:
            q: Commanded joint positions, in [rad]. Shape (n,).
            velocity: Commanded joint velocities, in [rad]/[s]. Shape (n,).

        Returns:
            In [rad]/[s]. Shape (2, n).
        """
        return np.asarray(joint_speeds(q, velocity, self.position, self.velocity, self.acceleration, self.dt))
