"""The switcher: which task the situation asks for (thesis 4.3.1, figure 4.5).

    ‖v_puck‖ > θ → defend;   else, on the own side: enough_space → hit, no space → prepare;   else home

Only a puck that comes towards the own goal needs defending; the thesis leaves that to its figure. Whether there is space for a
puck that has come to rest is decided once (`RestingPuck`).
"""

from dataclasses import dataclass

from airhockey.agents.estimation.motion import advance, puck_motion
from airhockey.agents.estimation.side_clock import HURRY
from airhockey.agents.skill import Situation
from airhockey.agents.thesis.policy import enough_space
from airhockey.agents.thesis.resting import RestingPuck
from airhockey.agents.thesis.state_machine import Task


@dataclass(frozen=True)
class SwitcherParameters:
    """Thresholds of the switcher.

    Attributes:
        defend_speed: θ, above which a puck that comes is defended against, in [m]/[s].
        approach_speed: Speed towards the own goal that counts as coming, in [m]/[s].
        reach_x: The puck is played where its x is less, in the table frame, in [m].
        side_tolerance, end_tolerance: Of `enough_space`, in [m].
        look_ahead: `enough_space` is asked of where the puck will be so much later, in [s].
        leave_home_early: The way home may be broken off for the next task; otherwise home is reached first.
        decide_once: Whether a puck that has come to rest can be played is decided once (`RestingPuck`); otherwise in every step.
        hurry: A puck that has been on the own side for long is hit wherever the mallet fits behind it.
    """

    defend_speed: float
    approach_speed: float
    reach_x: float
    side_tolerance: float
    end_tolerance: float
    look_ahead: float
    leave_home_early: bool
    decide_once: bool = True
    hurry: bool = True


class Switcher:
    """Chooses among the tasks that an environment is about."""

    def __init__(self, parameters: SwitcherParameters, tasks: frozenset[Task]) -> None:
        self._parameters, self._tasks = parameters, tasks
        self._constants = puck_motion().constants
        self._resting = RestingPuck()

    def reset(self) -> None:
        """A serve: forget the puck."""
        self._resting.reset()

    def choose(self, now: Situation) -> Task:
        """The task that the situation asks for; home where it is not among those that may be played."""
        self._resting.see(now.puck)
        task = self._wanted(now)
        return task if task in self._tasks else Task.HOME

    def _wanted(self, now: Situation) -> Task:
        p, puck = self._parameters, now.puck
        if puck.speed > p.defend_speed and puck.velocity[0] < -p.approach_speed:
            return Task.DEFEND
        if puck.position[0] >= p.reach_x:
            return Task.HOME
        if now.held > HURRY and enough_space(puck.position):  # in a hurry the mallet need only fit behind the puck
            return Task.HIT
        if p.decide_once and self._resting.playable is not None:
            return Task.HIT if self._resting.playable else Task.PREPARE
        later = puck.state.copy()
        advance(later, p.look_ahead, self._constants)
        return Task.HIT if enough_space(later[:2], p.side_tolerance, p.end_tolerance) else Task.PREPARE
