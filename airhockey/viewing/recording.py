"""What was played, as arrays that can be shown, and what happened in it."""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.editions import DEFAULT
from airhockey.envs.specs import CONTROL_PERIOD
from airhockey.viewing.caption import Caption

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Moment:
    """Something that happened.

    Attributes:
        step: Control step, from 1; 0 before the first one.
        what: "goal", "save", "fault", "point", "violation", "prepared", "stuck", "out", "serve", "held", "forfeit".
        who: 0 or 1, the player whom it is about; None for nobody in particular.
        text: One line about it, for people.
        speed: Of the shot, for a save in a game, in [m/s].
    """

    step: int
    what: str
    who: int | None = None
    text: str = ""
    speed: float = 0.0


class Narrator(Protocol):
    """Says how things stand."""

    def caption(self, step: int) -> Caption:
        """After so many control steps."""


@dataclass(frozen=True)
class Recording:
    """An episode or a game.

    Attributes:
        name: What `--episode` calls it.
        title: One line.
        env: The environment that it was played in.
        puck: x, y, yaw in the world, in [m] and [rad]. Shape (T, 3).
        puck_velocity: Its derivative. Shape (T, 3).
        joints: Joint positions, in [rad]. Shape (T, robots, n).
        moments: What happened, in order.
        narrator: Captions.
        edition: The year of its rules.
        first_step: The step that the first row shows: 0 for the start, 1 for the end of the first step.
    """

    name: str
    title: str
    env: str
    puck: Array
    puck_velocity: Array
    joints: Array
    narrator: Narrator
    moments: tuple[Moment, ...] = field(default=())
    first_step: int = 0
    edition: str = DEFAULT

    @property
    def steps(self) -> int:
        """Control steps played."""
        return len(self.puck) - 1 + self.first_step

    @property
    def duration(self) -> float:
        """How long it took, in [s]."""
        return self.steps * CONTROL_PERIOD

    def row(self, step: int) -> int:
        """The row that shows the scene after so many steps, the nearest one where there is none."""
        return min(max(step - self.first_step, 0), len(self.puck) - 1)
