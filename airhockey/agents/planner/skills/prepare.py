"""`prepare`: bring a puck that lies at a rim to where it can be played, by one well-chosen touch after the other.

Phases: `wait` (the puck rolls, or lies well), `think` (search for a push), `go round` (to where it begins), `strike`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from airhockey.agents.control.kinematics import spec_of
from airhockey.agents.control.workspace import Workspace
from airhockey.agents.estimation.motion import puck_motion
from airhockey.agents.parameters import load_parameters
from airhockey.agents.planner.contacts.puck_physics import put_on_table
from airhockey.agents.planner.estimation.rest_detection import RestDetection
from airhockey.agents.planner.motion.driving import drive, go_to, round_the_puck
from airhockey.agents.planner.pushes.push import (
    END,
    FOLLOW,
    LENGTH,
    PLACE,
    RETREAT,
    RUN_UP,
    START,
    VELOCITY,
    coast,
    mallet_at,
)
from airhockey.agents.planner.pushes.push_search import Found, Goal, finish, search, value, worth
from airhockey.agents.skill import Array, Situation
from airhockey.agents.table import CONTACT, to_table

FURTHER = 0.0025
"""How much further a push goes than the last, which has not touched the puck, in [m]."""
EFFORT = 25
"""Doubts about pushes that are played out in one control step, at most: they take 0.05 to 0.15 ms each."""
TOUCHED = 0.01
"""Way of the puck that shows that a push has touched it, in [m]."""


@dataclass(frozen=True)
class PrepareParameters:
    """What can be tuned: `prepare.yaml` beside this module.

    Attributes:
        goal: What a push shall achieve.
        speed, acceleration: Of the rod tip in a push, at most, along x and y.
        still: Speed below which a push is thought of, in [m]/[s].
        rolling: Speed above which the puck is not even watched, in [m]/[s].
        ahead: How long it takes from a decision to the contact, about, in [s].
        tries_per_step: Candidates that are tried in one control step.
        least_tries, most_tries: So many before a push is chosen; so many after which the best one must do.
        enough: Value of a push that needs no more thought.
        worthless: Value below which a push is not played.
        despair: How much less will do after every search in vain.
        travel_speed, travel_acceleration: On the way round the puck, in [m]/[s] and [m]/[s²].
        gap: Between mallet and puck on that way, in [m].
        arrived: Distance to the beginning of a push that will do, in [m].
        patience: Steps after which the way round is given up.
        seed: Of the search.
        sag: How far the iiwa's mallet, whose mass its controller does not know, hangs from its command, in [m].
        drift: How far the puck may turn out to lie elsewhere than thought, in [m]; beyond, it is thought again.
    """

    goal: Goal
    speed: tuple[float, ...]
    acceleration: tuple[float, ...]
    still: float
    rolling: float
    ahead: float
    tries_per_step: int
    least_tries: int
    most_tries: int
    enough: float
    worthless: float
    despair: float
    travel_speed: float
    travel_acceleration: float
    gap: float
    arrived: float
    patience: int
    seed: int
    sag: tuple[float, ...]
    drift: float


class Prepare:
    """Thinks while the puck lies still, and plays what it has found."""

    name = "prepare"

    def __init__(self, env_info: Mapping[str, Any], parameters: str | Path = "prepare") -> None:
        """Load the parameters and compile.

        Args:
            env_info: Description of the environment.
            parameters: Name or path of a YAML file.

        Raises:
            ConfigurationError: The file is not usable.
        """
        p = load_parameters(PrepareParameters, parameters, Path(__file__).parent)
        self._parameters = p
        self._grips = spec_of(env_info).n_joints == 7
        self._sag = np.array(p.sag) if self._grips else np.zeros(2)
        self._horizon = int(env_info["rl_info"].horizon)
        workspace = Workspace.of(env_info)
        self._lower, self._upper = to_table(workspace.lower), to_table(workspace.upper)
        self._upper[0] = min(self._upper[0], -0.1)
        self._goal = p.goal._replace(
            lower=self._lower,
            upper=self._upper,
            speed=np.array(p.speed),
            acceleration=np.array(p.acceleration),
            friction=1.0 if self._grips else 0.0,
        )
        self._tolerant = self._goal._replace(
            near_x=p.goal.near_x - 0.02, far_x=p.goal.far_x + 0.02, wide_y=p.goal.wide_y + 0.02
        )
        self._now = self._goal
        self._constants = puck_motion().constants
        self._watch = RestDetection(float(env_info["dt"]))
        self._restart()
        self._puck = np.array([-0.5, 0.45, 0.0, 0.0, 0.0])
        self._think(12)
        self._think_again()
        self._lies_well(self._puck, 1.0)
        put_on_table(self._puck, 0.0002)
        mallet_at(self._push, 0, np.float64(0.0))
        self._restart()

    def _restart(self) -> None:
        self.phase, self._well, self._rounds = "wait", False, 0
        self._missed = 0  # pushes in a row that have not moved the puck
        self._rng = np.random.default_rng(self._parameters.seed)
        self._forget()

    def _forget(self) -> None:
        self._push, self._value, self._tried = np.zeros(LENGTH), -2.0, 0
        self._time, self._steps, self._again = 0.0, 0, 0

    @property
    def finished(self) -> bool:
        """Whether the puck lies well, or is on its way there."""
        return self.phase == "wait" and self._well

    def begin(self, situation: Situation) -> None:
        """See `Skill.begin`."""
        self._watch.reset()
        self._restart()

    def act(self, situation: Situation) -> Array:
        """See `Skill.act`."""
        if self.phase == "strike" or situation.puck.speed > self._parameters.rolling:
            self._watch.reset()
        else:
            self._watch.see(situation.puck.position)
        if self.phase == "strike":
            return self._strike(situation)
        if self.phase == "wait":
            return self._wait(situation)
        if situation.puck.speed > self._parameters.rolling:  # somebody touched it
            self.phase = "wait"
            return self._wait(situation)
        if self.phase == "think":
            self._think(self._parameters.tries_per_step)
            if self._decided():
                self.phase, self._steps = "go round", 0
            return drive(situation, np.zeros(2), self._parameters.travel_acceleration)
        return self._go_round(situation)

    def _lies_well(self, puck: Array, left: float) -> bool:
        goal = self._tolerant
        ended, last = coast(puck, self._constants, goal.middle, min(goal.horizon, left))
        return bool(worth(ended, last, goal) >= 1.0)

    def _wait(self, situation: Situation) -> Array:
        p, puck = self._parameters, situation.puck.state
        left = (self._horizon - situation.step) * situation.dt
        self._well = self._lies_well(puck, left)
        if self._watch.ready and not self._well and np.hypot(*self._watch.motion()[1]) < p.still:
            self._forget()
            self._look(p.ahead)
            self._rounds = 0
            self._now = self._goal._replace(horizon=float(np.clip(left - p.ahead, 0.5, p.goal.horizon)))
            self.phase = "think"
        return self._keep_clear(situation)

    def _look(self, ahead: float) -> Array:
        """Believe the puck where it will be after a time, in [s]. Returns how far that is from the belief before. Shape (2,)."""
        before = self._puck[:2].copy()
        self._puck = np.array([*self._watch.after(ahead), 0.0, 0.0, 0.0])
        put_on_table(self._puck, 0.0002)
        return np.asarray(self._puck[:2] - before)

    def _think(self, tries: int) -> None:
        found = Found(self._push, self._value, self._tried)
        found = search(self._puck, found, self._now, self._constants, self._rng, tries, EFFORT)
        self._push, self._value, self._tried = found

    def _decided(self) -> bool:
        p = self._parameters
        if self._tried >= p.most_tries and self._value < p.worthless - p.despair * self._rounds:
            self._forget()
            self._rounds += 1  # rather a risky push than none
            self._now = self._now._replace(doubt=0.5 * self._now.doubt)
            return False
        return self._tried >= p.most_tries or (self._tried >= p.least_tries and self._value >= p.enough)

    def _go_round(self, situation: Situation) -> Array:
        p = self._parameters
        start = self._push[START : START + 2]
        self._steps += 1
        way = start - situation.tip
        if np.hypot(*way) < p.arrived and np.hypot(*situation.tip_velocity) < 0.02:
            moved = self._look(float(self._push[RUN_UP]))
            self._aim(moved)
            if np.hypot(*moved) > p.drift:
                self._think_again()
                return drive(situation, np.zeros(2), p.travel_acceleration)
            self._aim(-self._sag + self._further())
            self.phase, self._time = "strike", -self._push[RUN_UP]
            return self._strike(situation)
        if self._steps > p.patience:
            self.phase = "wait"
        target = round_the_puck(situation.tip, start, situation.puck.position, self._lower, self._upper, p.gap)
        return go_to(situation, target, p.travel_speed, p.travel_acceleration)

    def _aim(self, moved: Array) -> None:
        """Take the push along, as far as the table allows."""
        for part in (PLACE, END):
            self._push[part : part + 2] = np.clip(self._push[part : part + 2] + moved, self._lower, self._upper)

    def _further(self) -> Array:
        """By how much the next push goes further than planned, for those that did not reach the puck, in [m]. Shape (2,)."""
        velocity = self._push[VELOCITY : VELOCITY + 2]
        return np.asarray(FURTHER * self._missed / max(float(np.hypot(*velocity)), 1e-9) * velocity)

    def _think_again(self) -> None:
        """The puck lies elsewhere: begin with the push that was taken along.

        The first time as long as it takes; while a creeping puck is thought about, it creeps on, and so the next times are short.
        """
        p = self._parameters
        finish(self._push, self._now)
        self._value = value(self._puck, self._push, self._now, self._constants, -2.0)
        self._tried = max(0, (p.least_tries if self._again == 0 else p.most_tries) - 3 * p.tries_per_step)
        self._again += 1
        self.phase = "think"

    def _strike(self, situation: Situation) -> Array:
        self._time += situation.dt
        if self._time >= self._push[FOLLOW] + self._push[RETREAT]:
            self.phase = "wait"
            moved = np.hypot(*(situation.puck.position - self._puck[:2]))
            self._missed = self._missed + 1 if moved < TOUCHED else 0
        states = np.array([mallet_at(self._push, axis, self._time) for axis in range(2)])
        return situation.move(states[:, 0].copy(), states[:, 1].copy())

    def _keep_clear(self, situation: Situation) -> Array:
        """Make room for a rolling puck."""
        p, puck = self._parameters, situation.puck
        away = situation.tip - (puck.position + 0.15 * puck.velocity)
        distance = max(float(np.hypot(*away)), 1e-6)
        wanted = np.zeros(2)
        if distance < CONTACT + 2.0 * p.gap and puck.speed > p.still:
            wanted = away / distance * 0.5 * p.travel_speed
        return drive(situation, wanted, p.travel_acceleration)
