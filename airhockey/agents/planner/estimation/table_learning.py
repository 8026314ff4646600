"""What a table is like, learned while the puck moves over it: its damping, and the restitution of its side rims.

Both differ from serve to serve under disturbances, and a shot off a rim misses the goal by as much as they do. Where the puck
slides freely from one speed to another, the time that it takes tells the damping, c = ln(v₁/v₂)/t; a bounce off a side rim tells
the restitution. Each estimate is the mean of what was seen and of what was believed before, weighted by their precision.
"""

from math import hypot, log

from airhockey.agents.estimation.motion import puck_motion
from airhockey.agents.skill import Situation
from airhockey.agents.table import CONTACT

DAMPING_SPREAD = 0.06
"""Standard deviation of the damping from serve to serve, in [1/s]."""
SPEED_NOISE = 0.02
"""Of a filtered speed, in [m]/[s]."""
RESTITUTION_SPREAD, BOUNCE_SPREAD = 0.1, 0.15
"""Standard deviations of the restitution: from serve to serve, and from bounce to bounce."""
LARGEST = 1.1
"""Restitution beyond which none is believed."""
SETTLED = 0.14
"""Time after a touch or a bounce until the filter's velocity is right again, in [s]."""
SHORTEST, SLOWEST = 0.3, 0.25
"""Least duration [s] and speed [m]/[s] of a slide that tells anything."""
CLEAR = 0.06
"""Gap to mallets and ends beyond which the puck slides freely, in [m]."""
STEEP = 0.3
"""Least speed across of a bounce that tells anything, in [m]/[s]."""


class TableLearning:
    """Fed with every situation of a serve.

    Attributes:
        damping: c, in [1/s].
        restitution: Of the side rims.
    """

    def __init__(self) -> None:
        """Believe what is believed of any table."""
        constants = puck_motion().constants
        self._end, self._side, self._damping, self._restitution = (float(constants[i]) for i in (0, 1, 3, 5))
        self.reset()

    def reset(self) -> None:
        """A new serve: the table may be another."""
        self.damping, self._damping_weight = self._damping, DAMPING_SPREAD**-2
        self.restitution, self._restitution_weight = self._restitution, RESTITUTION_SPREAD**-2
        self._across = 0.0  # speed across in the step before, in [m]/[s]
        self._hit_rim_with = 0.0  # the same before the last bounce, until that is learned from
        self._slid = 0.0  # time since the last touch or bounce, in [s]
        self._first = self._latest = (0.0, 0.0)  # time [s] and speed [m]/[s] at which a slide began to tell, and now

    def see(self, situation: Situation) -> None:
        """Take what is known of the puck at every control step."""
        x, y, vx, vy = situation.puck.state[:4].tolist()
        before, self._across = self._across, vy
        mallets = (situation.tip, situation.opponent)
        gap = min(hypot(x - mallet[0], y - mallet[1]) - CONTACT for mallet in mallets if mallet is not None)
        if min(gap, self._end - abs(x)) < CLEAR or situation.puck.lost:
            self._learn_damping()
            self._hit_rim_with = 0.0
        elif before * vy < 0.0 and self._side - abs(y) < CLEAR:
            self._learn_damping()
            self._hit_rim_with = abs(before) if abs(before) > STEEP else 0.0
        else:
            self._slide(hypot(vx, vy), abs(vy), situation.dt)

    def _slide(self, speed: float, across: float, dt: float) -> None:
        self._slid += dt
        if self._slid < SETTLED:
            return
        self._latest = (self._slid, speed)
        if self._first[0] == 0.0:
            self._first = self._latest
        if self._hit_rim_with > 0.0:
            self._learn_restitution(across * (1.0 + self.damping * self._slid) / self._hit_rim_with)
            self._hit_rim_with = 0.0

    def _learn_damping(self) -> None:
        """The slide is over."""
        (begun, fast), (ended, slow) = self._first, self._latest
        duration = ended - begun
        if begun > 0.0 and duration > SHORTEST and fast > slow > SLOWEST:
            weight = (SPEED_NOISE * hypot(1.0 / fast, 1.0 / slow) / duration) ** -2
            self._damping_weight += weight
            self.damping += (log(fast / slow) / duration - self.damping) * weight / self._damping_weight
        self._slid, self._first = 0.0, (0.0, 0.0)

    def _learn_restitution(self, seen: float) -> None:
        weight = BOUNCE_SPREAD**-2
        self._restitution_weight += weight
        self.restitution += (min(seen, LARGEST) - self.restitution) * weight / self._restitution_weight
