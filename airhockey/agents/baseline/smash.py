"""`smash`: plan a shot at the opponent's goal, get behind the puck, strike, recover; again if the puck is still there."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from airhockey.agents.baseline.approach import FORESIGHT, approach
from airhockey.agents.baseline.opponent import OpponentTrack
from airhockey.agents.baseline.parameters import SmashParameters, smash_parameters
from airhockey.agents.baseline.planner import ShotPlanner
from airhockey.agents.baseline.shots import Shot
from airhockey.agents.baseline.skill import Array, Situation
from airhockey.agents.baseline.strike import Strike, run_up
from airhockey.agents.control.kinematics import spec_of
from airhockey.agents.control.workspace import Workspace

LARGEST_OFFSET = 0.03
"""How far the mallet may be from where the strike begins, in [m]."""
GUARD = -0.85
"""x from which the mallet watches a puck that offers no shot, in [m]."""


class Smash:
    """Phases: look (no shot yet), approach, strike, recover."""

    name = "smash"

    def __init__(self, env_info: Mapping[str, Any]) -> None:
        """Compile the search, so that the first step of a game is not slow."""
        spec = spec_of(env_info)
        self._parameters: SmashParameters = smash_parameters(spec)
        self._dt = float(env_info["dt"])
        p = self._parameters
        least = p.least_value_in_game if env_info["env_name"] == "tournament" else p.least_value
        self._planner = ShotPlanner(p, Workspace.of(env_info), self._dt, least)
        self._opponent = OpponentTrack(env_info)
        self.phase = "look"
        self.finished = False
        self._under_way: Strike | None = None
        self._time = 0.0
        self._shot: Shot | None = None
        self._scouted = -1
        self._horizon = env_info["rl_info"].horizon if str(env_info["env_name"]).endswith("hit") else 10**9

    def begin(self, situation: Situation) -> None:
        """See `Skill.begin`. What the scout knows is kept."""
        self.phase, self.finished = "look", False
        self._under_way = None

    def forget(self) -> None:
        """A new serve: the plan and what was seen of the opponent are void."""
        self._under_way, self._shot, self._scouted = None, None, -1
        self._planner.reset()
        self._opponent.reset()

    @property
    def committed(self) -> bool:
        """Whether a strike is under way."""
        return self._under_way is not None

    def scout(self, situation: Situation) -> Shot | None:
        """The shot that the player would go for now; to be called at every step, whichever skill acts."""
        if self._scouted != situation.step:
            self._scouted = situation.step
            if situation.opponent is not None:
                self._opponent.update(situation.opponent, situation.step)
            if not self.committed:
                self._shot = self._planner.plan(situation, self._opponent, self._time_left(situation))
        return self._shot

    def act(self, situation: Situation) -> Array:
        """See `Skill.act`."""
        shot = self.scout(situation)
        if self._under_way is not None:
            return self._strike(situation, self._under_way)
        if shot is None:
            return self._look(situation)
        self.phase = "approach"
        lead = run_up(shot.speed, self._parameters.acceleration, self._parameters.steady)[1]
        strike = self._make_strike(situation, shot)
        if shot.wait <= lead + 0.5 * self._dt:
            if np.hypot(*strike.offset) < LARGEST_OFFSET:
                self._under_way, self._time = strike, lead - shot.wait
                return self._strike(situation, strike)
            self._planner.reset()
        return self._go(situation, strike.start)

    def _time_left(self, situation: Situation) -> float:
        """Until the episode ends, in [s]."""
        return (self._horizon - situation.step) * self._dt

    def _make_strike(self, situation: Situation, shot: Shot) -> Strike:
        p = self._parameters
        start = shot.mallet - run_up(shot.speed, p.acceleration, p.steady)[0] * shot.normal
        return Strike(
            shot.mallet, shot.normal, shot.speed, p.acceleration, p.braking, p.steady, p.follow,
            situation.tip - start, situation.tip_velocity,
        )  # fmt: skip

    def _strike(self, situation: Situation, strike: Strike) -> Array:
        self.phase = "strike" if self._time < strike.contact_time + strike.follow else "recover"
        self._time += self._dt
        position, velocity = strike.at(self._time)
        if self._time > strike.duration:
            self._under_way = None
            self._planner.reset()
            self.finished = True
        return situation.move(position, velocity)

    def _look(self, situation: Situation) -> Array:
        self.phase = "look"
        y = float(np.clip(situation.puck_at(0.3)[0][1], -0.3, 0.3))
        return self._go(situation, np.array([GUARD, y]))

    def _go(self, situation: Situation, place: Array) -> Array:
        p = self._parameters
        ahead = situation.puck.position + FORESIGHT * situation.puck.velocity
        target, velocity = approach(
            situation.tip,
            situation.tip_velocity,
            place,
            p.approach_speed,
            p.approach_acceleration,
            self._dt,
            ahead,
            p.clearance,
        )
        return situation.move(target, velocity)
