"""The search for a shot, spread over the control steps: a few candidates at each, and the best so far is kept up to date."""

from math import copysign
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.control.workspace import Workspace
from airhockey.agents.planner.estimation.opponent import OpponentTrack
from airhockey.agents.planner.shots.flight import FLIGHT_STEP, coast, state_at
from airhockey.agents.planner.shots.kinds import ANY, OPEN, Kind
from airhockey.agents.planner.shots.parameters import SmashParameters
from airhockey.agents.planner.shots.shot_model import ALONG, ShotModel, make_shot_model
from airhockey.agents.planner.shots.shots import Attempt, Keeper, Shot, judge
from airhockey.agents.skill import Array, Situation
from airhockey.envs.compiled import pack

FLIGHT = 2.0
"""Longest flight after the longest wait for which the opponent is predicted, in [s]."""
GOOD = 0.85
"""Value of a shot beyond which the search for a better one slows down."""
BEYOND = 0.5
"""How much later another shot is then looked for, in [s]."""
LENIENCE = 0.1
"""By how much the shot pursued may be late, in [s]: the estimate of the way is cautious, and what is under way should go on."""
DECAY, RESTITUTION = 3, 5
"""Places in the constants of `PuckMotion`."""
_NONE = Shot(0.0, 0.0, 0.0, 0.0, 0.0, np.zeros(2), np.zeros(2))


class ShotPlanner:
    """Keeps the best shot found so far."""

    def __init__(self, parameters: SmashParameters, workspace: Workspace, dt: float, least: float) -> None:
        """Compile.

        Args:
            parameters: Of the hit.
            workspace: Where the mallet may be.
            dt: Length of a control step, in [s].
            least: Value below which there is no shot.
        """
        self._parameters, self._dt, self._least = parameters, dt, least
        model = make_shot_model(parameters, workspace)
        self._motion, self._model = model.motion, pack(model)
        self._times = np.arange(0.0, parameters.longest_wait + FLIGHT, FLIGHT_STEP)
        self.reset()
        path = coast(np.array([-0.5, 0.0, 0.0, 0.0, 0.0]), dt, 10, self._motion)
        search(path, dt, np.array([-0.8, 0.0]), np.zeros((2, 2)), 0.1, _NONE, 0, 2, 1.0, 0.0, *OPEN[1:], self._model)

    def reset(self) -> None:
        """Forget the shot."""
        self._kind = OPEN
        self._best = _NONE
        self._tried = 0

    def play_on(self, damping: float, restitution: float) -> None:
        """What the table is like: its damping, in [1/s], and the restitution of its side rims."""
        self._motion[DECAY], self._motion[RESTITUTION] = damping, restitution
        self._model["motion"] = self._motion
        self._model["slope"] = restitution / ALONG

    def plan(self, situation: Situation, opponent: OpponentTrack, time_left: float, kind: Kind = OPEN) -> Shot | None:
        """The best shot known now, or None where none is worth trying.

        Args:
            situation: Now.
            opponent: Brought up to date.
            time_left: Until the episode ends, in [s].
            kind: Of shot.
        """
        if kind != self._kind:
            self.reset()
            self._kind = kind
        p = self._parameters
        horizon = min(p.longest_wait, time_left - p.flight)
        best = self._best._replace(wait=self._best.wait - self._dt) if self._best.value > 0.0 else _NONE
        count = p.candidates
        if best.value > GOOD:
            count, horizon = count // 3, min(horizon, best.wait + BEYOND)
        steps = max(1, int(np.ceil(max(horizon, best.wait) / self._dt)))
        path: Array = coast(situation.puck.state, self._dt, steps, self._motion)
        self._best = search(
            path, self._dt, situation.tip,
            opponent.predict(self._times), 0.0 if opponent.swinging else p.opponent_doubt,
            best, self._tried, count, horizon, p.improvement,
            *kind[1:], self._model,
        )  # fmt: skip
        self._tried += count
        least = 0.0 if kind == ANY else self._least
        return self._best if self._best.value > least else None


@compiled
def search(
    path: Array,
    path_step: float,
    tip: Array,
    opponent: Array,
    doubt: float,
    best: Shot,
    first: int,
    count: int,
    horizon: float,
    improvement: float,
    rims: int,
    pace: float,
    lowest: float,
    post: int,
    heeds: bool,
    packed: NDArray[Any],
) -> Shot:
    """Try shots and keep the best: half of them anywhere, half of them near the best so far.

    Args:
        path: The puck's predicted states at every `path_step` [s] from now. Shape (k, 5).
        path_step: In [s].
        tip: As for `judge`.
        opponent, doubt: Of the `Keeper`.
        best: The best so far; its wait must have been brought up to date. Judged anew here.
        first: Number of candidates tried before: the candidates are a sequence of low discrepancy.
        count: How many to try.
        horizon: Longest wait, in [s].
        improvement: By how much another shot must be better than the best.
        rims, pace, lowest, post, heeds: As in `kinds.Kind`.
        packed: A record of `ShotModel`.
    """
    model = packed[0]
    horizon = min(horizon, _safe_time(path, path_step, model))
    keeper = Keeper(opponent, doubt, heeds)
    old = Attempt(best.wait, best.aim, best.wall, -LENIENCE)
    best = judge(state_at(path, path_step, best.wait), old, tip, keeper, pace, model)
    if best.wait > horizon:
        best = Shot(0.0, best.wait, best.aim, best.wall, best.speed, best.normal, best.mallet)
    bar = best.value + improvement if best.value > 0.0 else 0.0
    for i in range(first, first + count):
        u, v, w = (0.7548776662 * i) % 1.0, (0.5698402910 * i) % 1.0, (0.3819660113 * i) % 1.0
        if i % 2 == 0 or best.value == 0.0:
            wait = 0.1 + u * (horizon - 0.1)
            wall = float(max(rims, 1)) * (1.0 if w < 0.5 else -1.0)
            if rims == 0 or (rims < 0 and 0.2 < w < 0.8):
                wall = 0.0
            aim = 2.0 * v - 1.0
            aim = aim * (model.goal_half_width - lowest) + (lowest if aim > 0.0 else -lowest)
            if post != 0 and wall != 0.0:
                last = wall if rims % 2 == 1 else -wall  # where it bounces last
                aim = copysign(aim, post * last)
        else:
            wait, wall = best.wait + 0.1 * (u - 0.5), best.wall
            aim = best.aim + 0.05 * (v - 0.5)
            aim = (1.0 if aim > 0.0 else -1.0) * max(abs(aim), lowest)
        if wait > horizon or wait < 0.0:
            continue
        puck = state_at(path, path_step, wait)
        shot = judge(puck, Attempt(wait, aim, wall, model.approach_margin), tip, keeper, pace, model)
        if shot.value > bar:
            best, bar = shot, shot.value
    return best


@compiled
def _safe_time(path: Array, path_step: float, model: ShotModel) -> float:
    """Until the puck, left alone, comes to our own goal's mouth, in [s]: what comes later is not to be waited for."""
    for k in range(len(path)):
        if path[k, 0] < model.puck_radius - model.goal_line and abs(path[k, 1]) < model.mouth:
            return k * path_step
    return len(path) * path_step
