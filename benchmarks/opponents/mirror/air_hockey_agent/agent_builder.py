"""A mirror: copies the puck's y on a line before its goal, foresees nothing, and slams whatever has come near, wherever it lies,
as hard as it can at the middle of the goal."""

from math import hypot
from typing import Any

import numpy as np

from airhockey.agents.ordinary.player import BENT, LEFT, Array, PlainPlayer, straight

LINE = -0.78
"""x of the mallet while it copies, in [m]."""
TIMES = np.arange(0.2, 0.8, 0.05)

PATIENCE = 7.0
"""Time on its side after which it is content with any shove, in [s]."""


class Mirror(PlainPlayer):
    """Follows the puck sideways; one slam after the other."""

    def __init__(self, env_info: Any, agent_id: int = 1, **kwargs: Any) -> None:
        super().__init__(env_info, agent_id, **kwargs)
        self.posture = BENT

    def play(self) -> Array:
        """See `PlainPlayer.play`."""
        action = self.hitting((-0.4, 0.0), 8.0, 10)
        if action is not None:
            return action
        if self.x > -0.1 or self.speed > 0.35:
            return self.go(LINE, min(max(self.y, -0.3), 0.3), 1.2, 9.0, keep_off=self.vx > -0.2)
        if self.clock > PATIENCE:  # shove it away from behind, wherever it lies
            if self.tx < self.x - 0.05:
                return self.go(self.x + 0.1, self.y, 0.8, 5.0)
            return self.go(self.x - 0.1, self.y, 0.8, 5.0, keep_off=True)
        angle = straight(self.x, self.y, 0.0)
        sx, sy = max(self.x - 0.26 * np.cos(angle), LEFT), self.y - 0.26 * np.sin(angle)
        if hypot(self.tx - sx, self.ty - sy) > 0.03:
            return self.go(sx, sy, 1.0, 6.0, keep_off=True)
        for speed in (1.7, 1.4, 1.0, 0.6):
            self.hit = self.plan_hit(lambda x, y: straight(x, y, 0.0), speed, TIMES, hardest=22.0)
            if self.hit is not None:
                return self.go(sx, sy, 1.0, 6.0)
        return self.go(self.x, self.y, 0.8, 5.0)


def build_agent(env_info: Any, **kwargs: Any) -> Mirror:
    """See the challenge."""
    return Mirror(env_info, **kwargs)
