"""One control step of many environments, which any number of threads share out among themselves."""

from typing import Any

import numpy as np
from numba.core import types
from numba.extending import intrinsic
from numpy.typing import NDArray

from airhockey.envs.kernel.control_step import DONE, control_step
from airhockey.envs.tasks import defend, game, hit, prepare
from airhockey.envs.vector.compiling import compiled

Array = NDArray[np.float64]
Counts = NDArray[np.int64]

KINDS = ("hit", "defend", "prepare", "game")
"""The pages of `airhockey.envs.tasks` whose referees can be asked from here; a number stands for each in compiled code."""
_HIT, _DEFEND, _PREPARE = range(3)

_judge_hit, _judge_defend, _judge_prepare, _judge_game = hit.judge, defend.judge, prepare.judge, game.judge


@intrinsic
def _next(typing_context: Any, counter: Any) -> Any:
    """The counter's present value, and one more for whoever asks next, in whatever thread. Shape (1,), integers."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.atomic_rmw("add", array.data, context.get_constant(types.int64, 1), "seq_cst")

    return types.int64(counter), generate


@compiled
def judge(kind: int, referee: Any, left: Array) -> int:
    """The verdict of the referee of a kind of task; see `Task.judge`."""
    if kind == _HIT:
        return _judge_hit(referee, left)
    if kind == _DEFEND:
        return _judge_defend(referee, left)
    if kind == _PREPARE:
        return _judge_prepare(referee, left)
    return _judge_game(referee, left)


@compiled
def step_many(
    kind: int,
    memories: Any,
    referees: Any,
    actions: Array,
    noise: Array,
    left: Array,
    codes: Counts,
    verdicts: Counts,
    counter: Counts,
) -> None:
    """Step environments until none is left; called by several threads at once, each takes the next that nobody has taken.

    Args:
        kind: Index into `KINDS`.
        memories: The simulations' records. Shape (N,).
        referees: The referees' records. Shape (N,).
        actions: Padded to the same number of rows. Shape (N, R, rows, n).
        noise: Torques added in each substep, in [N·m]. Shape (N, 20, R, n), or (N, 0, R, n) for none.
        left: Written: what each step leaves (`kernel.observation.readings_of`). Shape (N, size).
        codes: Written: `DONE` or what went wrong (`kernel.control_step`). Shape (N,).
        verdicts: Written: the referees'. Shape (N,).
        counter: How many were taken; 0 to begin with. Shape (1,).
    """
    while True:
        i = _next(counter)
        if i >= memories.shape[0]:
            return
        codes[i] = control_step(memories[i : i + 1], actions[i], noise[i], left[i])
        if codes[i] == DONE:
            verdicts[i] = judge(kind, referees[i : i + 1], left[i])
