"""`thesis-final`: the thesis's last player (5.3): hit and prepare by rules, defend and home learned under constraints.

Networks come with the package for the iiwa. Where there is none for a robot and a task, the rule-based policy plays it.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from airhockey.agents.atacom.controller import AtacomController
from airhockey.agents.atacom.features import SLOW
from airhockey.agents.atacom.learned import FOLDER, LearnedSkill, trained
from airhockey.agents.atacom.skill import SKILLS
from airhockey.agents.base import Array
from airhockey.agents.control.joint_controller import JointController
from airhockey.agents.control.kinematics import spec_of
from airhockey.agents.skill import Situation
from airhockey.agents.table import CONTACT
from airhockey.agents.thesis.agent import ThesisAgent
from airhockey.agents.thesis.state_machine import Task

_STILL = 0.1
"""A puck slower than this, in [m]/[s], needs no more attention."""
_AWAY = 0.25
"""Nor does one so far in front of the mallet that goes away, in [m]."""


class TaskSkill:
    """A learned skill among the thesis's: it goes on from the rule-based player's command, and gives it back.

    Attributes:
        name, phase, finished: See `Skill`.
    """

    def __init__(self, task: Task, learned: LearnedSkill, commands: JointController) -> None:
        """Make a task of a skill.

        Args:
            task: Defend or home.
            learned: Plays it.
            commands: The rule-based player's controller: every command starts from its state and ends there.
        """
        self.name, self._learned, self._commands = task, learned, commands
        self.phase, self.finished = "learned", False

    def begin(self, now: Situation) -> None:
        """See `Skill.begin`."""
        self._learned.begin(now)
        self.phase, self.finished = "learned", False

    def act(self, now: Situation) -> Array:
        """See `Skill.act`."""
        state, learned = self._commands.state, self._learned
        learned.controller.reset(state.position, state.velocity)
        if learned.finished and self._comes_again(now):
            learned.begin(now)
        command = learned.act(now)
        self._commands.reset(*command)
        self.phase = learned.phase
        self.finished = learned.finished and self._over(now)
        return command

    def _comes_again(self, now: Situation) -> bool:
        """Whether a puck that was defended has bounced off something, and is on its way to the own goal once more."""
        coming = now.puck.velocity[0] < -SLOW and now.puck.position[0] - now.tip[0] > CONTACT
        return self.name is Task.DEFEND and bool(coming)

    def _over(self, now: Situation) -> bool:
        """Whether the next task may begin: after a defence only when the puck is out of the way."""
        if self.name is Task.HOME:
            return True
        ahead = float(now.puck.position[0] - now.tip[0])
        leaving = now.puck.velocity[0] > 0.0 and ahead > _AWAY
        return now.puck.speed < _STILL or leaving or ahead < 0.0


class FinalThesisAgent(ThesisAgent):
    """The thesis's player with a learned defence and a learned way home."""

    def __init__(
        self,
        env_info: Mapping[str, Any],
        agent_id: int = 1,
        defend: str | Path | None = None,
        home: str | Path | None = None,
        **kwargs: Any,
    ) -> None:
        """Build the player.

        Args:
            env_info: Description of the environment.
            agent_id: 1 or 2.
            defend, home: Networks, as files; by default those that come with the package for the robot, or else rules.
            kwargs: Those of `ThesisAgent`.

        Raises:
            ConfigurationError: A network is not usable.
        """
        super().__init__(env_info, agent_id, **kwargs)
        spec = spec_of(env_info)
        robot = f"{spec.n_joints}dof"
        atacom = AtacomController(spec, self._dt)
        for task, source in ((Task.DEFEND, defend), (Task.HOME, home)):
            if source is None and not (FOLDER / f"{task}_{robot}.npz").exists():
                continue
            learned = LearnedSkill(SKILLS[task], trained(task, robot, source), atacom)
            self._skills[task] = TaskSkill(task, learned, self._controller)
        self.reset()
