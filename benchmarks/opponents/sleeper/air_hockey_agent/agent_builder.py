"""A sleeper: keeps the puck for 14 s, standing between it and its goal, and shoots just before the fault, hard and off a rim or
straight."""

from math import hypot
from typing import Any

import numpy as np

from airhockey.agents.ordinary.player import BENT, LEFT, Array, PlainPlayer, bank, straight

WAKE, LATE = 12.2, 13.9
"""When it goes behind the puck, and from when on it shoves the puck away in any case, in [s]."""
TIMES = np.arange(0.3, 1.0, 0.05)


class Sleeper(PlainPlayer):
    """The clock is its weapon."""

    def __init__(self, env_info: Any, agent_id: int = 1, **kwargs: Any) -> None:
        super().__init__(env_info, agent_id, **kwargs)
        self.posture = BENT

    def play(self) -> Array:
        """See `PlainPlayer.play`."""
        action = self.hitting((0.0, 0.0), 8.0, 20)
        if action is not None:
            return action
        time = self.time_to(-0.8)
        if time is not None and self.speed > 0.25 and time < 4.0:
            y = self.ahead(time)[1]
            return self.go(-0.84, min(max(y, -0.25), 0.25), 1.2, 9.0)
        if self.x > 0.0 or self.clock < WAKE:
            share = 0.14 / max(self.x + 0.974, 0.25)
            return self.go(-0.85, share * self.y, 0.6, 4.0, keep_off=True)
        if self.clock > LATE:
            if self.tx < self.x - 0.05:
                return self.go(self.x + 0.1, self.y, 1.0, 6.0)
            return self.go(self.x - 0.1, self.y, 0.9, 5.0, keep_off=True)
        kind = self.step_count // 700 % 3 - 1.0
        aim = (lambda x, y: straight(x, y, 0.0)) if kind == 0.0 else (lambda x, y: bank(x, y, 0.0, kind))
        angle = aim(self.x, self.y)
        sx, sy = max(self.x - 0.25 * np.cos(angle), LEFT), self.y - 0.25 * np.sin(angle)
        if hypot(self.tx - sx, self.ty - sy) > 0.03:
            return self.go(sx, sy, 0.9, 5.0, keep_off=True)
        self.hit = self.plan_hit(aim, 1.4, TIMES, hardest=18.0)
        return self.go(sx, sy, 0.9, 5.0)


def build_agent(env_info: Any, **kwargs: Any) -> Sleeper:
    """See the challenge."""
    return Sleeper(env_info, **kwargs)
