"""A goalie: as deep as it can stand, slow to react (it sees the puck a fifth of a second late), and never in a hurry; clears the
puck past the keeper at 1.2 m/s, into the corner."""

from collections import deque
from math import hypot
from typing import Any

import numpy as np

from airhockey.agents.ordinary.player import LEFT, Array, PlainPlayer, straight

DELAY = 10
"""Steps by which its eyes lag while the puck is on the other side."""
TIMES = np.arange(0.4, 1.2, 0.1)
PATIENCE = 8.0
"""Time on its side after which it is content with any shove, in [s]."""


class Goalie(PlainPlayer):
    """Stays on its line; leaves it only for a puck that lies."""

    def reset(self) -> None:
        """See `PlainPlayer.reset`."""
        super().reset()
        self._seen: deque[tuple[float, float]] = deque(maxlen=DELAY)
        self.pause = 0

    def play(self) -> Array:
        """See `PlainPlayer.play`."""
        self._seen.append((self.x, self.y))
        action = self.hitting((0.0, 0.0), 6.0, 25)
        if action is not None:
            return action
        late_x, late_y = self._seen[0]
        if self.x > -0.05 or self.speed > 0.12:
            share = 0.06 / max(late_x + 0.974, 0.06)
            return self.go(LEFT, min(max(share * late_y, -0.12), 0.12), 0.6, 4.0, keep_off=self.speed < 0.3)
        if self.clock > PATIENCE:  # shove it away from behind, wherever it lies
            if self.tx < self.x - 0.05:
                return self.go(self.x + 0.1, self.y, 0.5, 3.0)
            return self.go(self.x - 0.1, self.y, 0.5, 3.0, keep_off=True)
        aim = 0.09 if self.step_count // 400 % 2 else -0.09
        angle = straight(self.x, self.y, aim)
        sx, sy = max(self.x - 0.2 * np.cos(angle), LEFT), self.y - 0.2 * np.sin(angle)
        if hypot(self.tx - sx, self.ty - sy) > 0.025:
            return self.go(sx, sy, 0.5, 3.0, keep_off=True)
        self.hit = self.plan_hit(lambda x, y: straight(x, y, aim), 0.8, TIMES)
        return self.go(sx, sy, 0.5, 3.0)


def build_agent(env_info: Any, **kwargs: Any) -> Goalie:
    """See the challenge."""
    return Goalie(env_info, **kwargs)
