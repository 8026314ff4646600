"""`ordinary`: meets the puck on a line before its goal, foresees no bounce, replans slowly, shoots straight.

It defends, prepares pucks that lie at a rim, and shoots pucks that lie well with 1 to 2 m/s at the middle of the goal.
"""

from math import hypot, pi

import numpy as np

from airhockey.agents.ordinary.player import LEFT, RIM_Y, TOUCH, Array, PlainPlayer, straight

LINE = -0.75
"""Where it meets the puck: x of the mallet, in [m]."""
REPLAN = 10
"""Steps between two looks at where the puck will cross the line."""
TIMES = np.arange(0.4, 1.2, 0.1)
NEAR_RIM = 0.10
"""A puck nearer to a side rim than this is prepared, in [m]."""


class OrdinaryAgent(PlainPlayer):
    """Ready, defend, prepare, smash; one after the other."""

    def reset(self) -> None:
        """See `PlainPlayer.reset`."""
        super().reset()
        self._cross = 0.0
        self.pause = 0

    def play(self) -> Array:
        """See `PlainPlayer.play`."""
        action = self.hitting((0.0, 0.0), 6.0, 20)
        if action is not None:
            return action
        if self.x > 0.0 or self.vx < -0.3:
            return self._defend()
        if self.speed > 0.25:
            return self.go(-0.86, 0.0, 0.6, 4.0, keep_off=True)
        if abs(self.y) > RIM_Y - NEAR_RIM or self.x < -0.78:
            return self._prepare()
        return self._smash()

    def _defend(self) -> Array:
        """On the line, where the straight way of the puck crosses it, as it was seen at the last look."""
        if self.step_count % REPLAN == 0:
            time = self.time_to(LINE)
            self._cross = 0.0 if time is None else self.ahead(time, bounces=False)[1]
        y = min(max(self._cross, -0.25), 0.25)
        return self.go(LINE if self.vx < -0.3 else -0.86, y, 0.9, 6.0)

    def _smash(self) -> Array:
        angle = straight(self.x, self.y, 0.0)
        sx, sy = max(self.x - 0.24 * np.cos(angle), LEFT), self.y - 0.24 * np.sin(angle)
        if hypot(self.tx - sx, self.ty - sy) > 0.03:
            return self.go(sx, sy, 0.6, 3.0, keep_off=True)
        speed = float(self.rng.uniform(0.7, 1.0))
        self.hit = self.plan_hit(lambda x, y: straight(x, y, 0.0), speed, TIMES)
        return self.go(sx, sy, 0.6, 3.0)

    def _prepare(self) -> Array:
        """Push it along the normal of the side rim, or off the end."""
        side = 1.0 if self.y > 0 else -1.0
        push = side * (pi / 2 if self.x > -0.7 else pi / 3)
        sx, sy = self.x - 0.13 * np.cos(push), self.y - 0.13 * np.sin(push)
        if self.x < -0.84:  # from beside, along the end
            sx, sy = max(self.x, LEFT), self.y - side * 0.13
        if hypot(self.tx - sx, self.ty - sy) > 0.02 and hypot(self.tx - self.x, self.ty - self.y) > TOUCH + 0.01:
            return self.go(sx, sy, 0.6, 3.0, keep_off=True)
        return self.go(self.x, self.y, 0.35, 3.0)
