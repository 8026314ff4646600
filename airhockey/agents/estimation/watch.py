"""From an observation to what a player knows: the puck filtered, and where the opponent's mallet is."""

from collections.abc import Mapping
from math import sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.estimation.kalman import Noise, PuckEstimate, filter_record, follow
from airhockey.agents.table import BASE_X, CONTACT

Array = NDArray[np.float64]

NEAR = 0.012
"""Gap between puck and mallet, in [m], at which they may be touching within a step."""


class Layout(NamedTuple):
    """Where things stand in an observation.

    Attributes:
        puck: Numbers of the entries that make up the puck's state. Shape (5,).
        opponent: The same of the opponent's mallet, x and y. Shape (2,).
        end: Size that an observation must have to say something of the opponent.
    """

    puck: NDArray[np.int64]
    opponent: NDArray[np.int64]
    end: int


def layout_of(env_info: Mapping[str, Any]) -> Layout:
    """The layout of an environment's observations."""
    puck = np.array([*env_info["puck_pos_ids"][:2], *env_info["puck_vel_ids"]], dtype=np.int64)
    opponent = np.array(env_info["opponent_ee_ids"], dtype=np.int64)
    nobody = len(opponent) == 0
    return Layout(puck, np.zeros(2, np.int64) if nobody else opponent[:2], 2**31 if nobody else int(opponent.max()) + 1)


class TableWatch:
    """Reads one observation per control step; everything it says is in the table frame."""

    def __init__(self, env_info: Mapping[str, Any], noise: Noise | None = None) -> None:
        """Set up the filter.

        Args:
            env_info: Description of the environment.
            noise: What the filter assumes.
        """
        layout = layout_of(env_info)
        self._record, self._end = filter_record(float(env_info["dt"]), noise, None, layout), layout.end
        self.see(np.zeros(int(layout.puck.max()) + 1), np.zeros(2))  # compile before the game
        self.reset()

    def reset(self) -> None:
        """A new serve: forget the puck."""
        self._record["begun"] = False

    def see(self, observation: Array, tip: Array) -> tuple[PuckEstimate, Array, Array | None]:
        """The puck now, our mallet (2,), and the opponent's (2,) or None where there is no opponent.

        Args:
            observation: In the robot frame. Shape (d,).
            tip: Commanded position of the rod tip, in the robot frame, in [m]. Shape (2,).
        """
        now, mallets = np.empty((6, 5)), np.empty((2, 2))
        lost = look(observation, tip, self._record, now, mallets)
        return PuckEstimate(now[0], now[1:], lost), mallets[0], mallets[1] if observation.size >= self._end else None


@compiled
def look(observation: Array, tip: Array, record: NDArray[Any], now: Array, mallets: Array) -> int:
    """All of `TableWatch.see` in one call of compiled code, because a player makes it in every control step.

    Args:
        observation, tip: As there.
        record: From `filter_record`, with a `Layout`.
        now: As for `kalman.follow`.
        mallets: Where the positions of both mallets are written, ours first. Shape (2, 2).

    Returns:
        For how many steps the track has been lost.
    """
    ids = record[0]
    puck = np.empty(5)
    for i in range(5):
        puck[i] = observation[ids.puck[i]]
    puck[0] += BASE_X
    mallets[0, 0], mallets[0, 1] = tip[0] + BASE_X, tip[1] + 0.0
    touching = _close(puck, mallets[0])
    if len(observation) >= ids.end:
        mallets[1, 0], mallets[1, 1] = observation[ids.opponent[0]] + BASE_X, observation[ids.opponent[1]]
        touching = touching or _close(puck, mallets[1])
    return follow(record, puck, touching, now)


@compiled
def _close(puck: Array, mallet: Array) -> bool:
    return sqrt((puck[0] - mallet[0]) ** 2 + (puck[1] - mallet[1]) ** 2) < CONTACT + NEAR
