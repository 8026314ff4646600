"""What a page of `airhockey.envs.tasks` gives: the task's start, its referee, its reward."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from airhockey.envs.editions import Start
from airhockey.envs.tasks.reward import Reward
from airhockey.envs.tasks.start import PuckState, draw


@dataclass(frozen=True)
class Task:
    """A task, whose page is its manual.

    Attributes:
        judge: Compiled: the verdict of a step from the referee's record (`Rules` and `Game`) and the flat array that the step
            left, which begins with the puck's state. Plus `SUCCESS`.
        reward: The thesis's, with its weights as defaults; a game has none.
        draw_start: Draws the puck's start from the areas that an edition's row names.
        players: How many robots take actions; with two it is a game, whose length and score are a game's.
    """

    judge: Callable[[Any, Any], int]
    reward: type[Reward] | None = None
    draw_start: Callable[[tuple[Start, ...], np.random.RandomState], PuckState] = draw
    players: int = 1
