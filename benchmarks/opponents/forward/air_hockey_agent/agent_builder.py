"""A forward: stands far up, between the puck and its goal, meets what comes early and knocks it on at once; its goal is often
empty."""

from math import hypot
from typing import Any

import numpy as np

from airhockey.agents.ordinary.player import GOAL_X, LEFT, Array, PlainPlayer, bank, straight

ADVANCE = 0.45
"""How far before its goal it stands, on the line from there to the puck, in [m]."""
TIMES = np.arange(0.12, 1.0, 0.04)
PATIENCE = 6.0
"""After so many seconds it shoves the puck on, wherever it lies."""


class Forward(PlainPlayer):
    """Attacks every puck; straight or off a rim by turns."""

    def __init__(self, env_info: Any, agent_id: int = 1, **kwargs: Any) -> None:
        super().__init__(env_info, agent_id, **kwargs)
        self._count = 0

    def play(self) -> Array:
        """See `PlainPlayer.play`."""
        before = self.hit
        action = self.hitting((0.0, 0.0), 8.0, 8)
        if action is not None:
            self._count += before is not self.hit
            return action
        if self.x < -0.1 and self.vx < 0.3 and self.step_count % 2 == 0:
            side = (0.0, 1.0, 0.0, -1.0)[self._count % 4]
            aim = (lambda x, y: bank(x, y, 0.0, side)) if side else (lambda x, y: straight(x, y, 0.0))
            self.hit = self.plan_hit(aim, 1.1, TIMES, hardest=18.0)
            if self.hit is not None:
                return self.follow(self.hit)[0]
        if self.x > -0.1 or self.vx < -0.3:
            x, y = self.ahead(0.15)
            way = max(hypot(x + GOAL_X, y), ADVANCE)
            share = ADVANCE / way
            return self.go(-GOAL_X + share * (x + GOAL_X), share * y, 1.0, 7.0)
        if self.clock > PATIENCE and self.tx < self.x:
            return self.go(self.x + 0.05, self.y, 0.7, 4.0)
        angle = straight(self.x, self.y, 0.0)
        return self.go(max(self.x - 0.2 * np.cos(angle), LEFT), self.y - 0.2 * np.sin(angle), 0.8, 5.0, keep_off=True)


def build_agent(env_info: Any, **kwargs: Any) -> Forward:
    """See the challenge."""
    return Forward(env_info, **kwargs)
