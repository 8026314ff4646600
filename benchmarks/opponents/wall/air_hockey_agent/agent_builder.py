"""A wall: stands before its goal where the puck will come, bounces included; pushes away what lies in its half, no more."""

from typing import Any

from airhockey.agents.ordinary.player import Array, PlainPlayer

LINE = -0.87
"""x of the mallet, in [m]."""


class Wall(PlainPlayer):
    """Only defends; a puck that stays is pushed over the middle at walking pace."""

    def play(self) -> Array:
        """See `PlainPlayer.play`."""
        time = self.time_to(LINE + 0.08)
        if time is not None and time < 3.0:
            y = self.ahead(time)[1]
            return self.go(LINE, min(max(y, -0.2), 0.2), 1.3, 10.0)
        if self.clock > 4.0 and self.speed < 0.2 and self.x < -0.02:
            behind = self.tx < self.x - 0.07 and abs(self.ty - self.y) < 0.03
            if not behind and self.x > -0.8:
                return self.go(self.x - 0.12, self.y, 0.6, 3.0, keep_off=True)
            return self.go(self.x + 0.1, self.y, 0.6, 3.0)
        if self.x > 0.0:
            share = 0.12 / max(self.x + 0.974, 0.2)
            return self.go(LINE, share * self.y, 0.8, 6.0)
        return self.go(LINE, min(max(0.4 * self.y, -0.1), 0.1), 0.5, 4.0, keep_off=True)


def build_agent(env_info: Any, **kwargs: Any) -> Wall:
    """See the challenge."""
    return Wall(env_info, **kwargs)
