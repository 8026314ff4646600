"""A shooter: 2.3 m/s from every puck that lies free, at the post that is farther from the keeper; it never prepares."""

from math import hypot
from typing import Any

import numpy as np

from airhockey.agents.ordinary.player import BENT, LEFT, Array, PlainPlayer, straight

SPEED = 1.6
"""Of the mallet: a puck at rest leaves with 1.45 times as much, in [m]/[s]."""
TIMES = np.arange(0.3, 1.0, 0.05)
PATIENCE = 12.0
"""After so many seconds it goes at the puck wherever it lies, to be rid of it."""


class Sniper(PlainPlayer):
    """Guards with a prediction, and shoots."""

    def __init__(self, env_info: Any, agent_id: int = 1, **kwargs: Any) -> None:
        super().__init__(env_info, agent_id, **kwargs)
        self.posture = BENT
        ids = env_info["opponent_ee_ids"]
        self._keeper = int(ids[1]) if len(ids) else None

    def reset(self) -> None:
        """See `PlainPlayer.reset`."""
        super().reset()
        self._aim, self.pause = 0.06, 0

    def draw_action(self, observation: Array) -> Array:
        """See `PlainPlayer.draw_action`."""
        if self._keeper is not None:
            self._aim = -0.07 if observation[self._keeper] > 0.0 else 0.07
        return super().draw_action(observation)

    def play(self) -> Array:
        """See `PlainPlayer.play`."""
        action = self.hitting((0.0, 0.0), 8.0, 15)
        if action is not None:
            return action
        time = self.time_to(-0.8)
        if time is not None and self.speed > 0.4:
            y = self.ahead(time)[1]
            return self.go(-0.82, min(max(y, -0.3), 0.3), 1.2, 8.0)
        if self.x > -0.1 or self.speed > 0.3:
            return self.go(-0.86, 0.3 * self.y, 0.8, 5.0, keep_off=True)
        if self.clock > PATIENCE:
            return self.go(self.x, self.y, 0.8, 4.0)
        angle = straight(self.x, self.y, self._aim)
        sx, sy = max(self.x - 0.3 * np.cos(angle), LEFT), self.y - 0.3 * np.sin(angle)
        if hypot(self.tx - sx, self.ty - sy) > 0.03:
            return self.go(sx, sy, 0.9, 5.0, keep_off=True)
        aim = self._aim
        self.hit = self.plan_hit(lambda x, y: straight(x, y, aim), SPEED, TIMES, hardest=20.0)
        return self.go(sx, sy, 0.9, 5.0)


def build_agent(env_info: Any, **kwargs: Any) -> Sniper:
    """See the challenge."""
    return Sniper(env_info, **kwargs)
