"""Learning rates over the iterations."""

import math
from typing import Literal, get_args

from airhockey.errors import unknown

Schedule = Literal["constant", "linear", "sqrt", "cosine"]
SCHEDULES: tuple[str, ...] = get_args(Schedule)


def learning_rate(schedule: str, rate: float, iteration: int, iterations: int) -> float:
    """The rate of an iteration.

    | schedule | rate in iteration h of H |
    |---|---|
    | constant | α |
    | linear | α (1 − h/H) |
    | sqrt | α / √(h + 1) |
    | cosine | α (1 + cos(π h/H)) / 2 |

    Args:
        schedule: One of `SCHEDULES`.
        rate: α.
        iteration: h, from 0.
        iterations: H.
    """
    share = iteration / iterations
    if schedule == "constant":
        return rate
    if schedule == "linear":
        return rate * (1.0 - share)
    if schedule == "sqrt":
        return rate / math.sqrt(iteration + 1)
    if schedule == "cosine":
        return rate * 0.5 * (1.0 + math.cos(math.pi * share))
    raise unknown("schedule of the learning rate", schedule, SCHEDULES)
