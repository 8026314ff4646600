"""`drop`: roll the puck slowly to where it dies in front of the opponent's goal, at its mallet's feet.

A defence that stops every shot is not beaten by one more. But a puck that lies beside a mallet which guards its goal is hard to
play: the mallet must first get round it, in little room. Whoever needs more than 15 s for that commits a fault, and three of them
are a point (challenge's section 6).

A puck that leaves with v₀ comes to rest after v₀/c, c being its damping: so the distance gives the speed of the strike. Table
and mallet are not quite as they are believed to be; so it is watched how far the puck rolls, and the next stroke corrected.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from airhockey.agents.base import task_of
from airhockey.agents.compiling import compiled
from airhockey.agents.control.kinematics import spec_of
from airhockey.agents.control.workspace import Workspace
from airhockey.agents.planner.estimation.rest_prediction import RestPrediction
from airhockey.agents.planner.motion.strike import Strike
from airhockey.agents.planner.shots.aiming import strike_normal
from airhockey.agents.planner.shots.flight import coast
from airhockey.agents.planner.shots.parameters import smash_parameters
from airhockey.agents.planner.shots.shot_model import ShotModel, make_shot_model
from airhockey.agents.planner.shots.shots import FORWARD, Line, Shot, possible, turned
from airhockey.agents.planner.skills.striker import Striker
from airhockey.agents.skill import Array, Situation
from airhockey.agents.table import CONTACT

PLACE = np.array([0.90, 0.085])
"""Where the puck would come to rest, in [m]; or at −y. At 0.05 m/s it is still 0.1 m away, and counts as lying."""
GAIN = 1.53
"""g of the contact at such speeds: measured, 1.53 ± 0.03 for mallets of 0.5 m/s."""
GAINS = (0.8 * GAIN, 1.25 * GAIN)
"""What it may be corrected to: the damping, which has the same effect, is within 20 % under `server`."""
SLOW = 0.15
"""Speed of a puck that can be dropped, in [m]/[s]."""
WAITS = np.arange(0.3, 2.0, 0.1)
"""Times until contact that are tried, in [s]."""
LENIENCE = 0.1
"""By how much the shot pursued may be late, in [s]."""
_DECAY = 3  # place in the constants of `PuckMotion`


class DeadPuck(Striker):
    """Phases: those of `Striker`."""

    name = "drop"

    def __init__(self, env_info: Mapping[str, Any]) -> None:
        """Compile.

        Args:
            env_info: Description of the environment.
        """
        parameters = smash_parameters(spec_of(env_info), in_game=task_of(env_info) == "tournament")
        super().__init__(parameters, float(env_info["dt"]))
        self._model = make_shot_model(parameters, Workspace.of(env_info))
        self._shot: Shot | None = None
        self._scouted = -1
        self._watch = RestPrediction(self._dt)
        self.forget()
        roll(np.array([-0.5, 0.0, 0.0, 0.0, 0.0]), Timing(1.0, 0.1), PLACE, GAIN, np.array([-0.8, 0.0]), self._model)

    def begin(self, situation: Situation) -> None:
        """See `Skill.begin`."""
        super().begin(situation)
        self._shot, self._scouted = None, -1

    def forget(self) -> None:
        """A new serve: what was learned of the table may not be so any more."""
        self._gain = GAIN
        self._from: float | None = None  # x at which the puck was struck, while it is worth watching

    def watch(self, situation: Situation) -> None:
        """Learn from how the puck rolls; to be called at every step, whichever skill acts."""
        if self._from is None:
            return
        rest = self._watch.see(float(situation.puck.position[0]))
        if rest is not None:
            gain = self._gain * (rest - self._from) / (PLACE[0] - self._from)
            self._gain = min(max(gain, GAINS[0]), GAINS[1])

    def abandon(self) -> None:
        """See `Striker.abandon`."""
        self._shot = None

    def scout(self, situation: Situation) -> Shot | None:
        """The stroke that the player would go for now; to be called at most once per step."""
        if self._scouted != situation.step:
            self._scouted = situation.step
            if not self.committed:
                self._shot = self._plan(situation)
        return self._shot

    def act(self, situation: Situation) -> Array:
        """See `Skill.act`."""
        shot = self.scout(situation)
        if self._under_way is not None:
            return self._play(situation, self._under_way)
        if shot is None:
            self.finished = True
            return self.go(situation, situation.tip)
        return self.pursue(situation, shot)

    def _play(self, situation: Situation, strike: Strike) -> Array:
        before = self.phase
        action = self.go_on(situation, strike)
        if before == "strike" and self.phase == "recover":
            self._watch.begin()
            self._from = float(strike.contact[0] + CONTACT * strike.normal[0])
        return action

    def _plan(self, situation: Situation) -> Shot | None:
        """The stroke pursued, brought up to date; where there is none, the first that is possible."""
        puck = situation.puck
        if puck.speed > SLOW or puck.position[0] > self._model.upper[0] + self._model.contact:
            return None
        path = coast(puck.state, self._dt, round(WAITS[-1] / self._dt), self._model.motion)
        if self._shot is not None and self._shot.wait > self._dt:
            wait, side = self._shot.wait - self._dt, self._shot.wall
            shot = self._roll(situation, path, wait, side, -LENIENCE)
            if shot.value > 0.0:
                return shot
        near = 1.0 if puck.position[1] > 0.0 else -1.0
        for wait in WAITS:
            for side in (near, -near):
                shot = self._roll(situation, path, float(wait), side, self._model.approach_margin)
                if shot.value > 0.0:
                    return shot
        return None

    def _roll(self, situation: Situation, path: Array, wait: float, side: float, margin: float) -> Shot:
        at_contact = path[min(round(wait / self._dt), len(path) - 1)]
        return roll(
            at_contact, Timing(wait, margin), PLACE * np.array([1.0, side]), self._gain, situation.tip, self._model
        )


class Timing(NamedTuple):
    """When a stroke meets the puck.

    Attributes:
        wait: Time until then, in [s].
        margin: Time to spare that the way to the stroke's beginning must leave, in [s].
    """

    wait: float
    margin: float


@compiled
def roll(puck: Array, timing: Timing, place: Array, gain: float, tip: Array, model: ShotModel) -> Shot:
    """The stroke after which the puck comes to rest at a place.

    Args:
        puck: Its state at contact. Shape (5,).
        timing: When it is met.
        place: In [m]. Shape (2,).
        gain: g of the contact, as far as it is known.
        tip: Where the mallet is now, in [m]. Shape (2,).
        model: Constants.

    Returns:
        Its `wall` is the sign of y; its `value` is 1, or 0 where it is impossible.
    """
    way = place - puck[:2]
    distance = np.hypot(way[0], way[1])
    speed = model.motion[_DECAY] * distance / gain
    normal = strike_normal(puck[2:4], way / distance, speed, gain)
    mallet = puck[:2] - model.contact * normal
    side = 1.0 if place[1] > 0.0 else -1.0
    fits = puck[0] <= model.upper[0] and normal[0] > FORWARD
    value = (
        1.0 if fits and possible(Line(mallet, normal, speed), timing.wait - timing.margin, tip, puck, model) else 0.0
    )
    commanded = turned(normal, model.turn)
    return Shot(value, timing.wait, place[1], side, speed, commanded, puck[:2] - model.contact * commanded)
