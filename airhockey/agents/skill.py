"""What every player of the package is made of: what it knows at a step (`Situation`), and what it can do (`Skill`).

In the plane of the table everything is given in the table frame (`airhockey.agents.table`: origin at its centre, x towards the
opponent), like the estimate of the puck. Only the joint controller thinks in the robot frame.
"""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.estimation.prediction import Crossing, puck_predictor

Array = NDArray[np.float64]


class Command(Protocol):
    """How a player's rod tip is commanded: see `JointController.move`."""

    def __call__(self, target: Array, velocity: Array | None = None, anchor: Array | None = None) -> Array:
        """The joint command that brings the rod tip to a place at the end of the coming step. Shape (2, n)."""


def no_command(target: Array, velocity: Array | None = None, anchor: Array | None = None) -> Array:
    """What a situation answers that is only looked at."""
    raise RuntimeError(f"nobody to move the rod tip to {target!r}: make the situation with a controller's `move`")


class Situation(NamedTuple):
    """What a player knows at one control step.

    Attributes:
        puck: Filtered, now, in the table frame.
        tip: Commanded position of the rod tip before this step, in the table frame, in [m]. Shape (2,).
        tip_velocity: Its commanded velocity, in [m]/[s]. Shape (2,).
        opponent: The opponent's mallet as seen, in the table frame, or None where there is no opponent. Shape (2,).
        dt: Length of a control step, in [s].
        step: Control steps since the serve; 0 at the first observation.
        move: Commands the rod tip.
        joints: Commanded joint positions before this step, in [rad]; None where nobody asks. Shape (n,).
        held: Time that the puck has been on our side, in [s]; see `SideClock`.
    """

    puck: PuckEstimate
    tip: Array
    tip_velocity: Array
    opponent: Array | None = None
    dt: float = 0.02
    step: int = 0
    move: Command = no_command
    joints: Array | None = None
    held: float = 0.0

    def puck_at(self, time: float) -> Array:
        """State (x, y, ẋ, ẏ, yaw rate) of the puck a time from now, in [s]. Shape (5,)."""
        return np.asarray(puck_predictor().path(self.puck, time)[-1])

    def puck_at_line(self, x: float, time: float) -> Crossing | None:
        """The puck's first passage of the line at x (table frame) within a time, in [s]."""
        return puck_predictor().at_line(self.puck, x, time)


class Skill(Protocol):
    """One thing that a player can do. Made once per player; begun many times.

    Attributes:
        name: Of the skill, for logs and pictures.
        phase: What it is doing, for logs and pictures.
    """

    @property
    def name(self) -> str:
        """See above."""

    @property
    def phase(self) -> str:
        """See above."""

    @property
    def finished(self) -> bool:
        """Whether there is nothing left to do: the player may choose another skill, or begin this one again."""

    def begin(self, situation: Situation) -> None:
        """Start afresh from this situation. `act` follows in the same step."""

    def act(self, situation: Situation) -> Array:
        """The joint command of this step. Shape (2, n)."""
