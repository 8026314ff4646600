"""The style of 2025's learned players: hits whatever comes, moving or not, as soon as the mallet can get there, at about 2.3 m/s,
without looking at the keeper; no preparation, no plan, a somewhat noisy aim."""

from math import hypot
from typing import Any

import numpy as np

from airhockey.agents.ordinary.player import BENT, LEFT, Array, PlainPlayer, straight

TIMES = np.arange(0.16, 0.9, 0.04)


class Volley(PlainPlayer):
    """Tries for a hit in every third step."""

    def __init__(self, env_info: Any, agent_id: int = 1, **kwargs: Any) -> None:
        super().__init__(env_info, agent_id, **kwargs)
        self.posture = BENT

    def play(self) -> Array:
        """See `PlainPlayer.play`."""
        action = self.hitting((-0.3, 0.0), 8.0, 12)
        if action is not None:
            return action
        near = self.x < 0.6 and self.vx < 0.2
        if near and self.step_count % 3 == 0:
            aim = float(self.rng.normal(0.0, 0.08))
            for speed in (1.55, 1.3, 1.0):
                self.hit = self.plan_hit(lambda x, y, aim=aim: straight(x, y, aim), speed, TIMES, hardest=22.0)
                if self.hit is not None:
                    action, _ = self.follow(self.hit)
                    return action
        time = self.time_to(-0.82)
        if time is not None and self.speed > 0.5:
            y = self.ahead(time)[1]
            return self.go(-0.86, min(max(y, -0.2), 0.2), 1.2, 9.0)
        if self.x > -0.08 or self.vx > 0.3 or self.speed > 0.6:
            return self.go(-0.86, 0.0, 0.8, 5.0, keep_off=True)
        angle = straight(self.x, self.y, 0.0)
        sx, sy = max(self.x - 0.28 * np.cos(angle), LEFT), self.y - 0.28 * np.sin(angle)
        if hypot(self.tx - sx, self.ty - sy) < 0.02:  # no hit from here: whatever moves it
            return self.go(self.x, self.y, 0.8, 5.0)
        if self.clock > 8.0:
            return self.go(self.x, self.y, 0.8, 5.0)
        return self.go(sx, sy, 0.9, 5.0, keep_off=True)


def build_agent(env_info: Any, **kwargs: Any) -> Volley:
    """See the challenge."""
    return Volley(env_info, **kwargs)
