"""One control step of many environments, which any number of threads share out among themselves."""

from typing import Any, NamedTuple

import numpy as np
from numba.core import types
from numba.extending import intrinsic
from numpy.typing import NDArray

from airhockey.envs.kernel.control_step import DONE as DONE
from airhockey.envs.kernel.control_step import control_step
from airhockey.envs.tasks import defend, game, hit, prepare
from airhockey.envs.vector.compiling import compiled
from airhockey.envs.vector.perception import Profile, Senses, observe, shake

Array = NDArray[np.float64]
Counts = NDArray[np.int64]

KINDS = ("hit", "defend", "prepare", "game")
"""The pages of `airhockey.envs.tasks` whose referees can be asked from here; a number stands for each in compiled code."""
_HIT, _DEFEND, _PREPARE = range(3)

_judge_hit, _judge_defend, _judge_prepare, _judge_game = hit.judge, defend.judge, prepare.judge, game.judge


@intrinsic
def next_of(typing_context: Any, counter: Any) -> Any:
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


class Fleet(NamedTuple):
    """N environments of a kind, as compiled code steps them.

    Attributes:
        kind: Index into `KINDS`.
        memories, referees: The simulations' and the referees' records. Each of shape (N,).
        actions: Padded to the same number of rows. Shape (N, R, rows, n).
        noise: Torques added in each substep, in [N·m]. Shape (N, 20, R, n), or (N, 0, R, n) for none.
        left: What the latest step left (`kernel.observation.readings_of`). Shape (N, size).
        first: Where the players' true observations begin there.
        codes: `DONE` or what went wrong in it (`kernel.control_step`). Shape (N,).
        verdicts: The referees', of the latest step. Shape (N,).
        profile, senses: Disturbances.
    """

    kind: int
    memories: Any
    referees: Any
    actions: Array
    noise: Array
    left: Array
    first: int
    codes: Counts
    verdicts: Counts
    profile: Profile
    senses: Senses


@compiled
def step_one(fleet: Fleet, i: int, observation: Array) -> int:
    """Environment i by one control step; gives its code.

    Args:
        fleet: Its action is there.
        i: Which one.
        observation: Written: what the players see. Shape (P D,).
    """
    if fleet.senses.shaken:
        shake(fleet.profile, fleet.senses, i, fleet.noise[i])
    left = fleet.left[i]
    code = control_step(fleet.memories[i : i + 1], fleet.actions[i], fleet.noise[i], left)
    fleet.codes[i] = code
    if code != DONE:
        return code
    fleet.verdicts[i] = judge(fleet.kind, fleet.referees[i : i + 1], left)
    if fleet.senses.blurred:
        players, width = fleet.senses.bias.shape[1], fleet.senses.bias.shape[2]
        for p in range(players):
            a = p * width
            true = left[fleet.first + a : fleet.first + a + width]
            observe(fleet.profile, fleet.senses, i, p, true, observation[a : a + width])
    else:
        for k in range(observation.shape[0]):
            observation[k] = left[fleet.first + k]
    return code


@compiled
def step_many(fleet: Fleet, observations: Array, counter: Counts) -> None:
    """Step environments until none is left; called by several threads at once, each takes the next that nobody has taken.

    Args:
        fleet: The environments.
        observations: Written. Shape (N, P D).
        counter: How many were taken; 0 to begin with. Shape (1,).
    """
    while True:
        i = next_of(counter)
        if i >= observations.shape[0]:
            return
        step_one(fleet, i, observations[i])
