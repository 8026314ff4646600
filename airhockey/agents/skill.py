"""What the skills of the planner share: what they see (`Situation`) and what they are (`Skill`).

In the plane of the table everything is given in the table frame (`airhockey.agents.table`: origin at its centre, x towards the
opponent), like the estimate of the puck. Only the joint controller thinks in the robot frame: `to_robot` is the way there.
"""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.control.joint_controller import JointController
from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.estimation.prediction import Crossing, PuckPredictor
from airhockey.agents.table import to_robot, to_table

Array = NDArray[np.float64]


class Situation:
    """What the player knows at one control step.

    Attributes:
        puck: Filtered, now, in the table frame.
        predictor: Carries `puck` on.
        controller: The last joint command, and the way to the next one. A skill commands through it, or sets `controller.state`
            when it commands joints itself.
        opponent: The opponent's mallet as seen, in the table frame, or None where there is no opponent. Shape (2,).
        step: Control steps since the serve; 0 at the first observation.
        dt: Length of a control step, in [s].
        tip: Commanded position of the rod tip before this step, in the table frame, in [m]. Shape (2,).
        tip_velocity: Its commanded velocity, in [m]/[s]. Shape (2,).
    """

    __slots__ = ("controller", "dt", "opponent", "predictor", "puck", "step", "tip", "tip_velocity")

    def __init__(
        self,
        puck: PuckEstimate,
        predictor: PuckPredictor,
        controller: JointController,
        opponent: Array | None,
        step: int,
        dt: float,
    ) -> None:
        self.puck, self.predictor, self.controller = puck, predictor, controller
        self.opponent, self.step, self.dt = opponent, step, dt
        state = controller.state
        self.tip, self.tip_velocity = to_table(state.tip), state.tip_velocity

    def puck_at(self, time: float) -> tuple[Array, Array]:
        """State (x, y, ẋ, ẏ, yaw rate) and covariance of the puck a time from now, in [s]. Shapes (5,), (5, 5)."""
        return self.predictor.at_time(self.puck, time)

    def puck_at_line(self, x: float, time: float) -> Crossing | None:
        """The puck's first passage of the line at x (table frame) within a time, in [s]."""
        return self.predictor.at_line(self.puck, x, time)

    def move(self, target: Array, velocity: Array | None = None, anchor: Array | None = None) -> Array:
        """Command the rod tip to a place at the end of the coming step.

        Args:
            target: In the table frame, in [m]. Shape (2,).
            velocity: Its velocity then, in [m]/[s]. Shape (2,).
            anchor: Posture that the null space is drawn to, in [rad]. Shape (n,).

        Returns:
            Joint command. Shape (2, n).
        """
        return self.controller.step(to_robot(target), velocity, anchor)


class Skill(Protocol):
    """One thing that the player can do. Made once per player, from `env_info`; begun many times.

    Attributes:
        name: "smash", "defend", "repel", "prepare" or "ready".
        phase: What it is doing, for logs and pictures.
    """

    name: str
    phase: str

    @property
    def finished(self) -> bool:
        """Whether there is nothing left to do: the player may choose another skill, or begin this one again."""

    def begin(self, situation: Situation) -> None:
        """Start afresh from this situation. `act` follows in the same step."""

    def act(self, situation: Situation) -> Array:
        """The joint command of this step. Shape (2, n)."""
