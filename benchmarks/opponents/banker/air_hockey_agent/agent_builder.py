"""A bank-shot player: always off a rim, the one that leaves the keeper the longer way; catches the puck first; prepares."""

from math import hypot, pi
from typing import Any

import numpy as np

from airhockey.agents.ordinary.player import BENT, LEFT, RIM_Y, TOUCH, Array, PlainPlayer, bank

TIMES = np.arange(0.3, 1.0, 0.05)


class Banker(PlainPlayer):
    """Defends with bounces foreseen, deep; then plays off alternate rims at 1.4 to 2 m/s."""

    def __init__(self, env_info: Any, agent_id: int = 1, **kwargs: Any) -> None:
        super().__init__(env_info, agent_id, **kwargs)
        self.posture = BENT
        self._count = 0

    def play(self) -> Array:
        """See `PlainPlayer.play`."""
        before = self.hit
        action = self.hitting((0.0, 0.0), 8.0, 20)
        if action is not None:
            self._count += before is not self.hit
            return action
        time = self.time_to(-0.78)
        if time is not None and self.speed > 0.3 and time < 3.0:
            y = min(max(self.ahead(time)[1], -0.3), 0.3)
            if time < 0.2:
                return self.toward(0.25 * max(self.vx, -2.5), 5.0 * (y - self.ty), 14.0)
            return self.go(-0.8, y, 1.2, 9.0)
        if self.x > -0.05 or self.speed > 0.2:
            return self.go(-0.85, 0.2 * self.y, 0.7, 4.0, keep_off=True)
        if abs(self.y) > RIM_Y - 0.09 or self.x < -0.8:
            return self._prepare()
        side = 1.0 if self._count % 2 == 0 else -1.0
        angle = bank(self.x, self.y, 0.0, side)
        sx, sy = max(self.x - 0.22 * np.cos(angle), LEFT), self.y - 0.22 * np.sin(angle)
        if abs(sy) > 0.45:
            self._count += 1
        if hypot(self.tx - sx, self.ty - sy) > 0.03:
            return self.go(sx, sy, 0.8, 4.0, keep_off=True)
        speed = 1.0 + 0.35 * (self._count // 2 % 2)
        self.hit = self.plan_hit(lambda x, y: bank(x, y, 0.0, side), speed, TIMES, hardest=18.0)
        if self.hit is None:
            self._count += 1
        return self.go(sx, sy, 0.8, 4.0)

    def _prepare(self) -> Array:
        side = 1.0 if self.y > 0 else -1.0
        push = side * (pi / 2 - 0.2)
        sx, sy = max(self.x - 0.13 * np.cos(push), LEFT), self.y - 0.13 * np.sin(push)
        if hypot(self.tx - sx, self.ty - sy) > 0.02 and hypot(self.tx - self.x, self.ty - self.y) > TOUCH + 0.01:
            return self.go(sx, sy, 0.6, 3.0, keep_off=True)
        return self.go(self.x, self.y, 0.4, 4.0)


def build_agent(env_info: Any, **kwargs: Any) -> Banker:
    """See the challenge."""
    return Banker(env_info, **kwargs)
