"""`defend`: catch the puck. The mallet meets it on its own line and yields, so that the puck comes to rest in front of our goal.

Phases: `approach` (on the way to the meeting), `catch` (the contact, on a straight line), `let go` (the puck comes to rest by
itself where it should: keep clear of it), `guard` (nothing to catch within reach: stay between puck and goal), `overtake` (a slow
puck is leaving: get ahead of it).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot
from pathlib import Path
from typing import Any

import numpy as np

from airhockey.agents.base import task_of
from airhockey.agents.control.cartesian import cubic
from airhockey.agents.control.kinematics import spec_of
from airhockey.agents.control.workspace import Workspace
from airhockey.agents.estimation.motion import advance, puck_motion
from airhockey.agents.parameters import load_parameters
from airhockey.agents.planner.contacts.interception import STEP, CatchCost, Reach, best_meeting, meeting, puck_path
from airhockey.agents.planner.contacts.redirection import resting_place
from airhockey.agents.planner.motion.driving import drive, go_to, round_the_puck
from airhockey.agents.skill import Array, Situation
from airhockey.agents.table import CONTACT, OWN_GOAL, to_table


@dataclass(frozen=True)
class ReachParameters:
    """What the planner believes of the rod tip. Attributes as in `interception.Reach`, along x and y."""

    speed: tuple[float, ...]
    acceleration: tuple[float, ...]


@dataclass(frozen=True)
class DefendParameters:
    """What can be tuned about the defence: `defend.yaml` beside this module.

    Attributes:
        iiwa, planar: What each robot's rod tip can do.
        wish: What makes a good place to catch.
        horizon: How far ahead the puck is predicted, in [s].
        too_hard: Effort beyond which a meeting counts as out of reach.
        every: A plan is made anew every so many steps.
        commit: Time before the contact from which on it stays, in [s].
        band: A puck that comes to rest between these x is left alone, in [m].
        clearance: Gap that is kept to such a puck, in [m].
        braking: Deceleration of the mallet when it has nothing to do, in [m]/[s²].
        guard_x, guard_y: Where the mallet's centre guards the goal, and how far from its middle at most, in [m].
        guard_speed: With which it goes there, in [m]/[s].
        overtake_speed: A puck slower than this that is leaving is overtaken, in [m]/[s].
        overtake_time: How far ahead of it, in [s].
        retreat_speed: How fast it makes room for a puck that is left alone, in [m]/[s].
    """

    iiwa: ReachParameters
    planar: ReachParameters
    wish: CatchCost
    horizon: float
    too_hard: float
    every: int
    commit: float
    band: tuple[float, ...]
    clearance: float
    braking: float
    guard_x: float
    guard_y: float
    guard_speed: float
    overtake_speed: float
    overtake_time: float
    retreat_speed: float


@dataclass(frozen=True)
class Meeting:
    """Where the mallet is to be when it touches the puck [m], its velocity then [m]/[s], and in how many [s]."""

    place: Array
    velocity: Array
    time: float


class Defend:
    """Plans anew at every step until the contact is near."""

    name = "defend"

    def __init__(self, env_info: Mapping[str, Any], parameters: str | Path = "defend") -> None:
        """Load the parameters and compile.

        Args:
            env_info: Description of the environment.
            parameters: Name or path of a YAML file.

        Raises:
            ConfigurationError: The file is not usable.
        """
        p = load_parameters(DefendParameters, parameters, Path(__file__).parent)
        self._parameters = p
        means = p.iiwa if spec_of(env_info).n_joints == 7 else p.planar
        workspace = Workspace.of(env_info)
        self._reach = Reach(
            np.array(means.speed), np.array(means.acceleration), to_table(workspace.lower), to_table(workspace.upper)
        )
        in_game = task_of(env_info) == "tournament"
        self._wish = p.wish._replace(grip=spec_of(env_info).n_joints == 7, aside=p.wish.aside if in_game else 0.0)
        self._constants = puck_motion().constants
        self._steps = round(p.horizon / STEP)
        self._meeting: Meeting | None = None
        self.phase = "guard"
        self._find(np.array([0.5, 0.0, -2.0, 0.1, 0.0]), np.array([-0.86, 0.0]), np.zeros(2))
        self._refined(np.array([0.5, 0.0, -2.0, 0.1, 0.0]), Meeting(np.zeros(2), np.zeros(2), 0.1))
        self._meeting = None
        resting_place(np.zeros(5), 0.1, self._constants)

    @property
    def finished(self) -> bool:
        """Whether the puck is at rest, or will be where it should."""
        return self.phase == "let go"

    def begin(self, situation: Situation) -> None:
        """See `Skill.begin`."""
        self._meeting = None
        self.phase = "guard"

    def act(self, situation: Situation) -> Array:
        """See `Skill.act`."""
        dt, wish = situation.dt, self._wish
        if self._meeting is not None and self._meeting.time < wish.lead + dt:  # too late to think again
            return self._catch(situation, self._meeting)
        if self._settles(situation.puck.state):
            self.phase, self._meeting = "let go", None
            return self._keep_clear(situation)
        if self._meeting is not None and self._meeting.time < self._parameters.commit:
            self._meeting = self._refined(situation.puck.state, self._meeting)
        elif self._meeting is None or situation.step % self._parameters.every == 0:
            self._meeting = self._find(situation.puck.state, situation.tip, situation.tip_velocity)
        if self._meeting is None:
            self.phase = "guard"
            return self._guard(situation)
        if self._meeting.time < wish.lead + dt:
            return self._catch(situation, self._meeting)
        return self._approach(situation, self._meeting)

    def _find(self, puck: Array, tip: Array, tip_velocity: Array) -> Meeting | None:
        """The best meeting of all."""
        wish = self._wish
        path = puck_path(puck, self._steps, wish.mouth, self._constants)
        present = round(self._meeting.time / STEP) if self._meeting is not None else -10
        index, _, need = best_meeting(path, tip, tip_velocity, self._reach, wish, present)
        if index < 0 or need > self._parameters.too_hard:
            return None
        place, velocity = meeting(path.states[index], wish)
        return Meeting(place, velocity, index * STEP)

    def _refined(self, puck: Array, plan: Meeting) -> Meeting:
        """The same meeting with what is known of the puck now."""
        state = puck.copy()
        advance(state, plan.time, self._constants)
        place, velocity = meeting(state, self._wish)
        return Meeting(place, velocity, plan.time)

    def _settles(self, puck: Array) -> bool:
        """Whether the puck comes to rest in the band, without a bounce."""
        x, y = resting_place(puck, self._wish.standstill, self._constants)
        near, far = self._parameters.band
        return bool(near < x < far and abs(y) < self._constants[1])

    def _approach(self, situation: Situation, plan: Meeting) -> Array:
        """One step along the cubic to where the straight line of the catch begins."""
        self.phase = "approach"
        time = plan.time - self._wish.lead
        self._meeting = Meeting(plan.place, plan.velocity, plan.time - situation.dt)
        begin = plan.place - self._wish.lead * plan.velocity
        way = cubic(situation.tip, situation.tip_velocity, begin, plan.velocity, time)
        return situation.move(*way.at(situation.dt))

    def _catch(self, situation: Situation, plan: Meeting) -> Array:
        """Along the puck's line at the yielding speed, through the contact; the plan is over afterwards."""
        self.phase = "catch"
        left = plan.time - situation.dt
        self._meeting = Meeting(plan.place, plan.velocity, left) if left > -self._wish.follow else None
        return situation.move(plan.place - left * plan.velocity, plan.velocity)

    def _keep_clear(self, situation: Situation) -> Array:
        """Slow down, and make room for the puck."""
        p = self._parameters
        away = situation.tip - (situation.puck.position + 0.1 * situation.puck.velocity)
        distance = max(hypot(*away), 1e-6)
        wanted = away / distance * p.retreat_speed if distance < CONTACT + p.clearance else np.zeros(2)
        return drive(situation, wanted, p.braking)

    def _guard(self, situation: Situation) -> Array:
        """Between the puck and the goal; or, where a slow puck is leaving, round it and ahead of it."""
        p, puck = self._parameters, situation.puck
        if puck.velocity[0] > 0.0 and puck.position[0] < self._wish.far_x and puck.speed < p.overtake_speed:
            self.phase = "overtake"
            ahead = situation.puck_at(p.overtake_time)[:2]
            place = ahead + (CONTACT + p.clearance) * puck.velocity / max(puck.speed, 1e-6)
            place = np.clip(place, self._reach.lower, self._reach.upper)
            return go_to(situation, self._way_round(situation, place), p.overtake_speed + 0.3, p.braking)
        share = (p.guard_x - OWN_GOAL[0]) / max(puck.position[0] - OWN_GOAL[0], 0.2)
        place = np.array([p.guard_x, np.clip(puck.position[1] * share, -p.guard_y, p.guard_y)])
        if puck.speed < p.overtake_speed:  # else it would be knocked into our goal on the way
            place = self._way_round(situation, place)
        return go_to(situation, place, p.guard_speed, p.braking)

    def _way_round(self, situation: Situation, place: Array) -> Array:
        """The next place on a way that does not touch the puck. Shape (2,)."""
        gap = 0.4 * self._parameters.clearance
        puck = situation.puck.position
        return round_the_puck(situation.tip, place, puck, self._reach.lower, self._reach.upper, gap)
