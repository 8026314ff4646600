"""What the thesis's policies share: what they answer, how that becomes a skill, and the room a hit needs."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.skill import Situation
from airhockey.agents.table import HALF_LENGTH, HALF_WIDTH
from airhockey.envs.specs import MALLET, PUCK

Array = NDArray[np.float64]

TOLERANCE = PUCK.radius + 2.0 * MALLET.radius
"""Room that a mallet needs behind the puck (4.10), in [m]."""


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

    def step(self, now: Situation) -> Move:
        """The next move."""


class RuleSkill:
    """A policy as a `Skill`: its moves become joint commands.

    Attributes:
        name: Of the task.
        finished: Whether its last move was the task's last.
    """

    def __init__(self, name: str, policy: Policy) -> None:
        self.name, self.finished = name, False
        self._policy = policy

    @property
    def phase(self) -> str:
        """See `Policy`."""
        return self._policy.phase

    def begin(self, now: Situation) -> None:
        """See `Skill.begin`."""
        self._policy.start()
        self.finished = False

    def act(self, now: Situation) -> Array:
        """See `Skill.act`."""
        move = self._policy.step(now)
        self.finished = move.finished
        return now.move(move.target, move.velocity)


def enough_space(puck_position: Array, side_tolerance: float = 0.0, end_tolerance: float | None = None) -> bool:
    """Whether a mallet fits behind the puck, as the thesis checks it before a hit (4.2.3).

    Args:
        puck_position: In the table frame, in [m]. Shape (2,).
        side_tolerance: Additional margin to the borders, in [m].
        end_tolerance: The same at the short borders, where it differs: room to take a run-up.
    """
    end = side_tolerance if end_tolerance is None else end_tolerance
    x, y = puck_position.tolist()
    return bool(HALF_LENGTH - end - abs(x) >= TOLERANCE and HALF_WIDTH - side_tolerance - abs(y) >= TOLERANCE)
