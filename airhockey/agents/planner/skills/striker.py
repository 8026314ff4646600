"""What skills share that strike the puck: get to where the strike begins, in time, then strike and recover."""

import numpy as np

from airhockey.agents.planner.motion.approach import FORESIGHT, Pace, approach
from airhockey.agents.planner.motion.strike import Strike, run_up
from airhockey.agents.planner.shots.parameters import SmashParameters
from airhockey.agents.planner.shots.shots import Shot
from airhockey.agents.skill import Array, Situation

LARGEST_OFFSET = 0.03
"""How far the mallet may be from where the strike begins, in [m]."""


class Striker:
    """Pursues one shot after the other. Phases: approach, strike, recover.

    Attributes:
        phase: See above.
        finished: A strike is over.
    """

    def __init__(self, parameters: SmashParameters, dt: float) -> None:
        self._parameters, self._dt = parameters, dt
        self._posture = np.array(parameters.posture)
        self.phase, self.finished = "look", False
        self._under_way: Strike | None = None
        self._time = 0.0

    def begin(self, situation: Situation) -> None:
        """See `Skill.begin`."""
        self.phase, self.finished = "look", False
        self._under_way = None

    @property
    def committed(self) -> bool:
        """Whether a strike is under way."""
        return self._under_way is not None

    def abandon(self) -> None:
        """The shot that was pursued is over, or came too late: forget it."""

    def pursue(self, situation: Situation, shot: Shot) -> Array:
        """One step towards a shot, or of its strike once its time has come. Shape (2, n)."""
        self.phase = "approach"
        lead = run_up(shot.speed, self._parameters.acceleration, self._parameters.steady)[1]
        strike = self._make_strike(situation, shot)
        if shot.wait <= lead + 0.5 * self._dt:
            if np.hypot(*strike.offset) < LARGEST_OFFSET:
                self._under_way, self._time = strike, lead - shot.wait
                return self.go_on(situation, strike)
            self.abandon()
        return self.go(situation, strike.start)

    def go_on(self, situation: Situation, strike: Strike) -> Array:
        """One step of a strike. Shape (2, n)."""
        self.phase = "strike" if self._time < strike.contact_time + strike.follow else "recover"
        self._time += self._dt
        position, velocity = strike.at(self._time)
        if self._time > strike.duration:
            self._under_way = None
            self.abandon()
            self.finished = True
        return situation.move(position, velocity, self._anchor(situation))

    def go(self, situation: Situation, place: Array) -> Array:
        """One step towards a place, round the puck. Shape (2, n)."""
        p = self._parameters
        ahead = situation.puck.position + FORESIGHT * situation.puck.velocity
        pace = Pace(p.approach_speed, p.approach_acceleration, p.clearance)
        target, velocity = approach(situation.tip, situation.tip_velocity, place, pace, self._dt, ahead)
        return situation.move(target, velocity, self._anchor(situation))

    def _anchor(self, situation: Situation) -> Array | None:
        """What draws the joints to the stroke's posture; None where it has none. Shape (n,)."""
        q = situation.joints
        if q is None or len(self._posture) == 0:
            return None
        return np.asarray(q + self._parameters.posture_gain * (self._posture - q))

    def _make_strike(self, situation: Situation, shot: Shot) -> Strike:
        p = self._parameters
        start = shot.mallet - run_up(shot.speed, p.acceleration, p.steady)[0] * shot.normal
        return Strike(
            shot.mallet, shot.normal, shot.speed, p.acceleration, p.braking, p.steady, p.follow,
            situation.tip - start, situation.tip_velocity,
        )  # fmt: skip
