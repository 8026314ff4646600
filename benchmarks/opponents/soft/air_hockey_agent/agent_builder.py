"""A soft player: lets the puck come to rest, goes behind it and returns it at about 0.7 m/s, always; prepares by nudges."""

from math import hypot
from typing import Any

import numpy as np

from airhockey.agents.ordinary.player import LEFT, RIGHT, Array, PlainPlayer, straight

TIMES = np.arange(0.3, 1.0, 0.1)
SPEED = 0.5


class Soft(PlainPlayer):
    """Follows the puck's height as a keeper; yields when it comes, so that it stays."""

    def play(self) -> Array:
        """See `PlainPlayer.play`."""
        action = self.hitting((0.0, 0.0), 8.0, 0, through=0.06)
        if action is not None:
            return action
        time = self.time_to(-0.78)
        if time is not None and self.speed > 0.3:
            y = min(max(self.ahead(time)[1], -0.35), 0.35)
            if time < 0.25:  # give way
                return self.toward(0.3 * max(self.vx, -2.0), 4.0 * (y - self.ty), 12.0)
            return self.go(-0.76, y, 1.1, 8.0)
        if self.x > -0.05 or self.speed > 0.2:
            return self.go(-0.84, min(max(self.y, -0.15), 0.15), 0.7, 4.0, keep_off=True)
        if abs(self.y) > 0.38 or self.x < -0.8:
            return self._nudge()
        angle = straight(self.x, self.y, 0.0)
        sx, sy = max(self.x - 0.16 * np.cos(angle), LEFT), self.y - 0.16 * np.sin(angle)
        if hypot(self.tx - sx, self.ty - sy) > 0.02:
            return self.go(sx, sy, 0.6, 3.0, keep_off=True)
        self.hit = self.plan_hit(lambda x, y: straight(x, y, 0.0), SPEED, TIMES)
        return self.go(sx, sy, 0.6, 3.0)

    def _nudge(self) -> Array:
        """Against the rim from inside, slightly forwards: it bounces off towards the middle."""
        side = 1.0 if self.y > 0 else -1.0
        sx, sy = max(self.x - (0.05 if self.x > -0.85 else 0.0), LEFT), self.y - side * 0.11
        if hypot(self.tx - sx, self.ty - sy) > 0.02 and self.phase != "nudge":
            return self.go(sx, min(max(sy, -RIGHT), RIGHT), 0.6, 3.0, keep_off=True)
        self.phase = "nudge" if hypot(self.tx - self.x, self.ty - self.y) < 0.2 and self.speed < 0.1 else "guard"
        return self.go(self.x + 0.01, self.y, 0.4, 4.0)


def build_agent(env_info: Any, **kwargs: Any) -> Soft:
    """See the challenge."""
    return Soft(env_info, **kwargs)
