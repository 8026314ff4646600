"""What the thesis's policies share: what they see, what they answer, and the room a hit needs."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.table import HALF_LENGTH, HALF_WIDTH
from airhockey.envs.specs import MALLET, PUCK

Array = NDArray[np.float64]

TOLERANCE = PUCK.radius + 2.0 * MALLET.radius
"""Room that a mallet needs behind the puck (4.10), in [m]."""


class View(NamedTuple):
    """What a policy decides on, in the table frame.

    Attributes:
        puck: Filtered.
        tip: Commanded position of the end-effector, in [m]. Shape (2,).
        tip_velocity: Commanded velocity, in [m]/[s]. Shape (2,).
        opponent: The opponent's end-effector, or None where there is none. Shape (2,).
        dt: Length of a control step, in [s].
    """

    puck: PuckEstimate
    tip: Array
    tip_velocity: Array
    opponent: Array | None
    dt: float


class Move(NamedTuple):
    """What a policy wants of the end-effector.

    Attributes:
        target: Its position at the end of the coming step, in the table frame, in [m]. Shape (2,).
        finished: This was the task's last action: the switcher is asked what comes next.
        velocity: Its velocity then, in [m]/[s], where the policy knows it. Shape (2,).
    """

    target: Array
    finished: bool = False
    velocity: Array | None = None


class Policy(Protocol):
    """A task: hit, defend, prepare or home.

    Attributes:
        phase: What it is doing, for logs and pictures.
    """

    phase: str

    def start(self) -> None:
        """The task begins: timers to zero."""

    def step(self, view: View) -> Move:
        """The next move."""


def enough_space(puck_position: Array, side_tolerance: float = 0.0, end_tolerance: float | None = None) -> bool:
    """Whether a mallet fits behind the puck, as the thesis checks it before a hit (4.2.3).

    Args:
        puck_position: In the table frame, in [m]. Shape (2,).
        side_tolerance: Additional margin to the borders, in [m].
        end_tolerance: The same at the short borders, where it differs: room to take a run-up.
    """
    end = side_tolerance if end_tolerance is None else end_tolerance
    x, y = float(puck_position[0]), float(puck_position[1])
    return HALF_LENGTH - end - abs(x) >= TOLERANCE and HALF_WIDTH - side_tolerance - abs(y) >= TOLERANCE
