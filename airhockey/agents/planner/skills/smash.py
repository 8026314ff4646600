"""`smash`: plan a shot at the opponent's goal, get behind the puck, strike, recover; again if the puck is still there."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from airhockey.agents.base import task_of
from airhockey.agents.control.kinematics import spec_of
from airhockey.agents.control.workspace import Workspace
from airhockey.agents.planner.estimation.opponent import OpponentTrack
from airhockey.agents.planner.estimation.table_learning import TableLearning
from airhockey.agents.planner.shots.kinds import OPEN, Kind
from airhockey.agents.planner.shots.parameters import smash_parameters
from airhockey.agents.planner.shots.shot_search import ShotPlanner
from airhockey.agents.planner.shots.shots import Shot
from airhockey.agents.planner.skills.striker import Striker
from airhockey.agents.skill import Array, Situation

GUARD = -0.85
"""x from which the mallet watches a puck that offers no shot, in [m]."""


class Smash(Striker):
    """Phases: look (no shot yet), and those of `Striker`."""

    name = "smash"

    def __init__(self, env_info: Mapping[str, Any]) -> None:
        """Compile the search, so that the first step of a game is not slow."""
        task = task_of(env_info)
        in_game = task == "tournament"
        p = smash_parameters(spec_of(env_info), in_game)
        super().__init__(p, float(env_info["dt"]))
        least = p.least_value_in_game if in_game else p.least_value
        self._planner = ShotPlanner(p, Workspace.of(env_info), self._dt, least)
        self._opponent = OpponentTrack(env_info)
        self._shot: Shot | None = None
        self._scouted = -1
        self.kind = OPEN
        self._horizon = env_info["rl_info"].horizon if task == "hit" else 10**9

    def aim_for(self, kind: Kind) -> None:
        """What kind of shot to look for from now on."""
        self.kind = kind

    def play_on(self, table: TableLearning) -> None:
        """What the table is like, from now on."""
        self._planner.play_on(table.damping, table.restitution)

    @property
    def pursuing(self) -> bool:
        """Whether there is a shot that was found before."""
        return self._shot is not None

    def forget(self) -> None:
        """A new serve: the plan and what was seen of the opponent are void."""
        self._under_way, self._shot, self._scouted = None, None, -1
        self._planner.reset()
        self._opponent.reset()

    def abandon(self) -> None:
        """See `Striker.abandon`."""
        self._planner.reset()

    def scout(self, situation: Situation) -> Shot | None:
        """The shot that the player would go for now; to be called at every step, whichever skill acts."""
        if self._scouted != situation.step:
            self._scouted = situation.step
            if situation.opponent is not None:
                self._opponent.update(situation.opponent, situation.step)
            if not self.committed:
                self._shot = self._planner.plan(situation, self._opponent, self._time_left(situation), self.kind)
        return self._shot

    def act(self, situation: Situation) -> Array:
        """See `Skill.act`."""
        shot = self.scout(situation)
        if self._under_way is not None:
            return self.go_on(situation, self._under_way)
        return self._look(situation) if shot is None else self.pursue(situation, shot)

    def _time_left(self, situation: Situation) -> float:
        """Until the episode ends, in [s]."""
        return (self._horizon - situation.step) * self._dt

    def _look(self, situation: Situation) -> Array:
        self.phase = "look"
        y = float(np.clip(situation.puck_at(0.3)[1], -0.3, 0.3))
        return self.go(situation, np.array([GUARD, y]))
