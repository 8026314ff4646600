"""What a player sees of the true state: noise, bias, lost tracks and delay, from the player's own random stream."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.disturbances import Disturbances
from airhockey.envs.random_stream import Stream

Array = NDArray[np.float64]


class PerceptionState(NamedTuple):
    """A moment of a player's perception: its random stream, the episode's biases, what was seen, how long the puck is lost."""

    random: Any
    bias: Array
    seen: tuple[Array, ...]
    lost_for: int


class Perception:
    """Disturbs one player's observations.

    Args:
        disturbances: The profile.
        n_joints: Number of joints n; an observation is puck (6), joints (2n) and, if there is one, the opponent (3).

    Attributes:
        deviation: Standard deviations of an observation's entries. Shape (6 + 2n + 3,).
        random: The player's stream, since the latest reset.
    """

    def __init__(self, disturbances: Disturbances, n_joints: int) -> None:
        self._profile = disturbances
        self._n = n_joints
        puck, joints = disturbances.puck, disturbances.joints
        self.deviation = np.concatenate(
            (
                [puck.position, puck.position, puck.yaw, puck.velocity, puck.velocity, puck.yaw_rate],
                np.full(n_joints, joints.position),
                np.full(n_joints, joints.velocity),
                np.full(3, disturbances.opponent.position),
            )
        )
        self._bias = np.zeros(self.deviation.size)
        self._seen: tuple[Array, ...] = ()  # never changed, but replaced: saved states keep the old
        self._kept = disturbances.delay + 1
        self._lost_for = 0
        self._stream: Stream | None = None

    def reset(self, random: np.random.Generator) -> None:
        """Begin an episode: draw its biases; nothing has been seen yet."""
        if self._stream is None or self._stream.generator is not random:
            self._stream = Stream(random)
        self.random = random
        self._bias = np.zeros(self.deviation.size)  # a new one: saved states keep the old
        self._bias[:2] = random.normal(0.0, self._profile.puck.position_bias, 2)
        self._bias[6 : 6 + self._n] = random.normal(0.0, self._profile.joints.position_bias, self._n)
        self._seen = ()
        self._lost_for = 0

    def observe(self, true: Array) -> Array:
        """What the player sees when `true` is the case. Shape as `true`, always a fresh array."""
        size = true.size
        seen = true + self._bias[:size] + self.deviation[:size] * self.random.standard_normal(size)
        if abs(seen[2]) > math.pi:  # only then: player 2's yaw may be +pi, and wrapping costs the last bit
            seen[2] = (seen[2] + math.pi) % (2.0 * math.pi) - math.pi
        self._lose_track(seen)
        self._seen = (*self._seen, seen)[-self._kept :]
        return self._seen[0].copy()

    def save(self) -> PerceptionState:
        """What the next observations depend on besides the truth."""
        assert self._stream is not None  # since the first reset
        return PerceptionState(self._stream.save(), self._bias, self._seen, self._lost_for)

    def restore(self, state: PerceptionState) -> None:
        """Go back to what was saved, of this player or of one like it."""
        assert self._stream is not None
        random, self._bias, self._seen, self._lost_for = state
        self._stream.restore(random)

    def _lose_track(self, seen: Array) -> None:
        """During a loss, show the last state of the puck that was seen."""
        loss = self._profile.track_loss
        if self._lost_for == 0 and self.random.random() < loss.probability:
            self._lost_for = int(self.random.integers(loss.length[0], loss.length[1] + 1))
        if self._lost_for == 0:
            return
        self._lost_for -= 1
        if not self._seen:
            return  # nothing seen yet that could be shown again
        seen[:6] = self._seen[-1][:6]
        if loss.shows == "zero_velocity":
            seen[3:6] = 0.0
