"""A learner's step of many environments in one compiled call: the command, the control steps, the filter, the reward."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.learned import actions, features
from airhockey.agents.learned.actions import Controls, command, take_position
from airhockey.agents.learned.features import Features, Sights, see, write
from airhockey.envs.specs import JOINTS
from airhockey.envs.tasks.verdicts import GOING_ON
from airhockey.envs.tasks.verdicts import SUCCESS as SUCCEEDED
from airhockey.envs.vector.stepping import DONE, Fleet, next_of, step_one
from airhockey.learning.envs.compiling import compiled, inlined
from airhockey.learning.envs.rewards import FAILURE, PROGRESS, SHAPED, SUCCESS, potential

Array = NDArray[np.float64]
Counts = NDArray[np.int64]


class Learner(NamedTuple):
    """What stands between a learner and N environments.

    Attributes:
        repeat: Control steps that an action lasts.
        horizon: Control steps after which an episode ends.
        discount: γ of the shaping.
        reward: Index into `rewards.REWARDS`.
        controls, sights: Of the actions and of the observations.
        raw: The environments' own observations. Shape (N, D).
        steps: Control steps since the episode's beginning. Shape (N,).
        potential: Φ after the latest step. Shape (N,).
        best: The highest Φ of the episode. Shape (N,).
        rewards: Of the latest step. Shape (N,).
        constraints: Where the constraint values stand in what a step leaves: from, to. Shape (2,).
        played, violated: Control steps so far, and in how many of them a constraint was violated. Shapes (N,), (N,).
    """

    repeat: int
    horizon: int
    discount: float
    reward: int
    controls: Controls
    sights: Sights
    raw: Array
    steps: Counts
    potential: Array
    best: Array
    rewards: Array
    constraints: Counts
    played: Counts
    violated: Counts


def warm_up(fleet: Fleet, learner: Learner) -> None:
    """Compile what allocates, before what calls it."""
    controls, sights = learner.controls, learner.sights
    actions.warm_up(controls)
    features.warm_up(sights)
    potential(fleet.kind, sights.puck[0, 0], controls.tip[0], sights.constants)


@compiled
def play_many(fleet: Fleet, learner: Learner, chosen: Array, seen: Features, counter: Counts) -> None:
    """Play environments until none is left; see `airhockey.envs.vector.stepping.step_many`.

    Args:
        chosen: The actions. Shape (N, m).
        seen: Written: the features. Shape (N, W), or (N, 0) where only the raw observations are asked for.
    """
    while True:
        i = next_of(counter)
        if i >= chosen.shape[0]:
            return
        play_one(fleet, learner, i, chosen[i], seen[i])


@inlined
def play_one(fleet: Fleet, learner: Learner, i: int, action: Array, written: Features) -> None:
    """Let an action last for `repeat` control steps, or less where the episode ends."""
    ended = success = False
    for _ in range(learner.repeat):
        command(learner.controls, i, action, fleet.actions[i, 0])
        if step_one(fleet, i, learner.raw[i]) != DONE:
            return
        learner.steps[i] += 1
        _count_violation(learner, i, fleet.left[i])
        see(learner.sights, learner.controls, i, learner.raw[i], learner.steps[i] == 0)
        verdict = fleet.verdicts[i]
        success = verdict >= SUCCEEDED
        ended = verdict % SUCCEEDED != GOING_ON or learner.steps[i] >= learner.horizon
        if ended:
            break
    if written.size > 0:
        write(learner.sights, learner.controls, i, 1.0 - learner.steps[i] / learner.horizon, written)
    learner.rewards[i] = _reward(fleet, learner, i, ended, success)


@inlined
def _reward(fleet: Fleet, learner: Learner, i: int, ended: bool, success: bool) -> float:
    """See `rewards`."""
    own = 0.0
    if ended:
        own = SUCCESS if success else FAILURE
    if learner.reward == SHAPED:
        before = learner.potential[i]
        learner.potential[i] = 0.0 if ended else _potential(fleet, learner, i)
        return float(own + learner.discount * learner.potential[i] - before)
    if learner.reward == PROGRESS:
        best = learner.best[i]
        learner.best[i] = max(best, _potential(fleet, learner, i))
        return float(own + learner.best[i] - best)
    return 1.0 if ended and success else 0.0


@compiled
def begin_one(fleet: Fleet, learner: Learner, i: int, written: Features) -> None:
    """Begin an episode from the environment's own first observation."""
    n = learner.controls.q.shape[1]
    take_position(learner.controls, i, learner.raw[i, JOINTS : JOINTS + n])
    see(learner.sights, learner.controls, i, learner.raw[i], learner.steps[i] == 0)
    learner.potential[i] = learner.best[i] = _potential(fleet, learner, i)
    if written.size > 0:
        write(learner.sights, learner.controls, i, 1.0, written)


@compiled
def _potential(fleet: Fleet, learner: Learner, i: int) -> float:
    return potential(fleet.kind, learner.sights.puck[i, 0], learner.controls.tip[i], learner.sights.constants)


@inlined
def _count_violation(learner: Learner, i: int, left: Array) -> None:
    learner.played[i] += 1
    for k in range(learner.constraints[0], learner.constraints[1]):
        if left[k] > 0.0:
            learner.violated[i] += 1
            return
