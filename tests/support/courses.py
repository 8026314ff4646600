"""Courses of games with closed forms: v(t) = v₀ e^(-kt), so that a puck comes to rest v₀ / k further on."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.estimation.motion import puck_motion
from airhockey.envs.specs import CONTROL_PERIOD, MALLET, PUCK, TABLE
from airhockey.evaluator.analysis.shots import Shot, shots_of
from airhockey.evaluator.runs.game_records import Event, Side

Array = NDArray[np.float64]
K = PUCK.slide_damping / PUCK.mass  # [1/s]
KEEP = float(np.exp(-K * CONTROL_PERIOD))
LINE = TABLE.length / 2
REACH = PUCK.radius + MALLET.radius
LATERAL = TABLE.width / 2 - PUCK.radius


@dataclass
class Course:
    """Rows of a game, built step by step; the players' mallets are where they were put."""

    x: float = -0.4
    y: float = 0.0
    velocity: Array = field(default_factory=lambda: np.zeros(2))
    home: tuple[float, float] = (-0.9, 0.0)
    away: tuple[float, float] = (0.9, 0.0)
    rows: list[Array] = field(default_factory=list)
    events: list[Event] = field(default_factory=lambda: [Event(step=0, what="serve", who="home")])

    def slide(self, steps: int) -> "Course":
        for _ in range(steps):
            travel = (1.0 - KEEP) / K
            self.x, self.y = self.x + self.velocity[0] * travel, self.y + self.velocity[1] * travel
            self.velocity = self.velocity * KEEP
            self._keep()
        return self

    def slide_to(self, x: float) -> "Course":
        """Slide on until the next step would be beyond x."""
        while abs(x - self.x) > abs(self.velocity[0]) * CONTROL_PERIOD:
            self.slide(1)
        return self

    def hit(self, side: Side, *velocity: float) -> "Course":
        """The mallet of a side gives the puck another velocity, at the beginning of a step."""
        impulse = np.array(velocity) - self.velocity
        behind = np.array([self.x, self.y]) - REACH * impulse / np.hypot(*impulse)
        setattr(self, side, (float(behind[0]), float(behind[1])))
        self.rows[-1][43:45] = self.home
        self.rows[-1][20:22] = self.away
        self.velocity = np.array(velocity)
        return self.slide(1)

    def bounce(self) -> "Course":
        """Off a side rim, which keeps a share of the normal velocity and takes a share of the slip."""
        motion = puck_motion()
        self.velocity = self.velocity * [1.0 - motion.slip_impulse, -motion.restitution]
        return self.slide(1)

    def score(self, who: Side) -> "Course":
        """A goal for a side after the last step, and a serve."""
        self.events.append(Event(step=len(self.rows), what="goal", who=who, score=(1, 0)))
        self.events.append(Event(step=len(self.rows), what="serve", who="away"))
        self.x, self.y, self.velocity = 0.4, 0.0, np.zeros(2)
        return self.slide(5)

    def shots(self) -> list[Shot]:
        return shots_of(np.array(self.rows), self.events)

    def outcomes(self) -> list[tuple[Side, str]]:
        return [(shot.side, shot.outcome) for shot in self.shots()]

    def mirrored(self) -> list[Shot]:
        """The shots of the same game seen from the other end."""
        rows = np.array(self.rows)
        rows[:, [0, 1, 3, 4, 20, 21, 43, 44]] *= -1.0
        rows[:, [20, 21, 43, 44]] = rows[:, [43, 44, 20, 21]]
        other: dict[Side | None, Side | None] = {"home": "away", "away": "home", None: None}
        events = [Event(step=event.step, what=event.what, who=other[event.who]) for event in self.events]
        return shots_of(rows, events)

    def _keep(self) -> None:
        row = np.zeros(46)
        row[:5] = self.x, self.y, 0.0, *self.velocity
        row[20:22], row[43:45] = self.away, self.home
        self.rows.append(row)
