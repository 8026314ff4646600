"""What a learner observes: numbers of order one, in the table frame, within [−5, 5].

| index | quantity | unit |
|---|---|---|
| 0, 1 | puck x + 0.5, y, filtered | m, 0.5 m |
| 2, 3, 4 | puck velocity, yaw rate, filtered | 2 m/s, 2 m/s, 20 rad/s |
| 5, 6 | tip x + 0.8, y, of the command | 0.2 m, 0.5 m |
| 7, 8 | tip velocity | m/s |
| 9, 10 | from tip to puck | 0.5 m, 0.5 m |
| 11, 12 | where the puck will cross x = −0.7: time, y | s, 0.5 m |
| 13, 14 | velocity there | 2 m/s |
| 15 | from tip to crossing, y | 0.2 m |
| 16 | share of the episode that is left | |
| 17, 18 | opponent's mallet x − 0.6, y; 0 without one | 0.2 m, 0.5 m |
| 19 … 34 | puck as it was observed, and tip, in each of the 4 latest steps: x, y, x, y | m |
| 35 … 34+2n | joint positions and velocities of the command; only with the action *joints* | limits |
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.atacom.features import HORIZON, LINE, crossing
from airhockey.agents.compiling import compiled, in_place
from airhockey.agents.estimation.kalman import filter_record
from airhockey.agents.estimation.motion import puck_motion
from airhockey.agents.estimation.watch import layout_of, look
from airhockey.agents.learned.actions import Controls
from airhockey.agents.table import BASE_X

Array = NDArray[np.float64]
Features = NDArray[np.float32]

STACK = 4
"""Steps whose positions are remembered."""
_FIXED = 19
LARGEST = 5.0


class Sights(NamedTuple):
    """What N learners know of the table.

    Attributes:
        watches: Filters of the puck, records of `estimation.watch`. Shape (N,).
        puck: The estimates; the first row is the state, in the table frame. Shape (N, 6, 5).
        mallets: Ours and the opponent's, in the table frame, in [m]. Shape (N, 2, 2).
        opponent: Whether there is one.
        recent: Positions of puck and tip, the latest first. Shape (N, STACK, 4).
        crossing: Where the puck will cross the line: time, y, ẋ, ẏ. Shape (N, 4).
        seen: The puck as it was observed, in the table frame. Shape (N, 2).
        tip: Of the command, in the robot frame, as the filter wants it. Shape (N, 2).
        joints: Whether the joints are observed, too.
        constants: `PuckMotion.constants`.
    """

    watches: NDArray[np.void]
    puck: Array
    mallets: Array
    opponent: bool
    recent: Array
    crossing: Array
    seen: Array
    tip: Array
    joints: bool
    constants: Array


def new_sights(env_info: Mapping[str, Any], joints: bool, n_envs: int) -> Sights:
    """Of n environments; `joints`: whether the joints are observed, too."""
    layout = layout_of(env_info)
    return Sights(
        np.repeat(filter_record(float(env_info["dt"]), None, None, layout), n_envs),
        np.zeros((n_envs, 6, 5)),
        np.zeros((n_envs, 2, 2)),
        len(env_info["opponent_ee_ids"]) > 0,
        np.zeros((n_envs, STACK, 4)),
        np.zeros((n_envs, 4)),
        np.zeros((n_envs, 2)),
        np.zeros((n_envs, 2)),
        joints,
        puck_motion().constants,
    )


def width_of(joints: bool, n: int) -> int:
    """The number of features."""
    return _FIXED + 4 * STACK + (2 * n if joints else 0)


def warm_up(sights: Sights) -> None:
    """Compile what allocates, before what calls it: or numba takes the caller's options for it."""
    _cross(sights.puck[0, 0], sights.constants, sights.crossing[0])
    seen = np.zeros(int(sights.watches["end"][0]) if sights.opponent else int(sights.watches["puck"].max()) + 1)
    look(seen, sights.tip[0], sights.watches[:1], sights.puck[0], sights.mallets[0])


@in_place
def see(sights: Sights, controls: Controls, i: int, observation: Array, first: bool) -> None:
    """Take an observation into the filter and into the stack.

    Args:
        observation: Environment i's own. Shape (D,).
        first: Whether it is an episode's first.
    """
    if first:
        sights.watches[i].begun = False
    seen, tip = sights.seen[i], sights.tip[i]
    seen[0], seen[1] = observation[0] + BASE_X, observation[1]
    tip[0], tip[1] = controls.tip[i, 0] - BASE_X, controls.tip[i, 1]
    look(observation, tip, sights.watches[i : i + 1], sights.puck[i], sights.mallets[i])
    remember(sights, controls, i, seen, first)


@in_place
def remember(sights: Sights, controls: Controls, i: int, seen: Array, first: bool) -> None:
    """Take the latest positions into the stack; at an episode's first observation they fill it.

    Args:
        seen: The puck's position in the table frame, as it was observed. Shape (2,).
        first: Whether this is the first.
    """
    recent = sights.recent[i]
    for k in range(STACK - 1, 0, -1):
        for j in range(4):
            recent[k, j] = recent[k - 1, j]
    recent[0, 0], recent[0, 1] = seen[0], seen[1]
    recent[0, 2], recent[0, 3] = controls.tip[i, 0], controls.tip[i, 1]
    if first:
        for k in range(1, STACK):
            for j in range(4):
                recent[k, j] = recent[0, j]


@in_place
def write(sights: Sights, controls: Controls, i: int, left: float, features: Features) -> None:
    """Write the features of environment i; see this module's docstring.

    Args:
        left: Share of the episode that is left.
        features: Shape (`width_of`,).
    """
    puck, tip, tip_velocity = sights.puck[i, 0], controls.tip[i], controls.tip_velocity[i]
    there = sights.crossing[i]
    _cross(puck, sights.constants, there)
    features[0], features[1] = puck[0] + 0.5, 2.0 * puck[1]
    features[2], features[3], features[4] = 0.5 * puck[2], 0.5 * puck[3], 0.05 * puck[4]
    features[5], features[6] = 5.0 * (tip[0] + 0.8), 2.0 * tip[1]
    features[7], features[8] = tip_velocity[0], tip_velocity[1]
    features[9], features[10] = 2.0 * (puck[0] - tip[0]), 2.0 * (puck[1] - tip[1])
    features[11], features[12] = there[0], 2.0 * there[1]
    features[13], features[14] = 0.5 * there[2], 0.5 * there[3]
    features[15], features[16] = 5.0 * (there[1] - tip[1]), left
    features[17] = 5.0 * (sights.mallets[i, 1, 0] - 0.6) if sights.opponent else 0.0
    features[18] = 2.0 * sights.mallets[i, 1, 1] if sights.opponent else 0.0
    for k in range(STACK):
        for j in range(4):
            features[_FIXED + 4 * k + j] = sights.recent[i, k, j]
    if sights.joints:
        n, limits = controls.q.shape[1], controls.model.limits
        for j in range(n):
            features[_FIXED + 4 * STACK + j] = controls.q[i, j] / limits.position[1, j]
            features[_FIXED + 4 * STACK + n + j] = controls.velocity[i, j] / limits.velocity[1, j]
    for k in range(features.size):
        features[k] = min(max(features[k], np.float32(-LARGEST)), np.float32(LARGEST))


@compiled
def _cross(puck: Array, constants: Array, there: Array) -> None:
    there[:] = crossing(puck, LINE, HORIZON, constants)
