"""`thesis-final`: the thesis's last player (5.3): hit and prepare by rules, defend and home learned under constraints.

Networks come with the package for the iiwa. Where there is none for a robot and a task, the rule-based policy plays it.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from airhockey.agents.atacom.controller import AtacomController
from airhockey.agents.atacom.features import SLOW
from airhockey.agents.atacom.learned import FOLDER, LearnedSkill, trained
from airhockey.agents.atacom.skill import SKILLS, Situation
from airhockey.agents.base import Array
from airhockey.agents.control.joint_controller import JointController
from airhockey.agents.control.kinematics import spec_of
from airhockey.agents.table import CONTACT, to_robot
from airhockey.agents.thesis.agent import ThesisAgent
from airhockey.agents.thesis.policy import Move, View
from airhockey.agents.thesis.state_machine import Task

_STILL = 0.1
"""A puck slower than this, in [m]/[s], needs no more attention."""
_AWAY = 0.25
"""Nor does one so far in front of the mallet that goes away, in [m]."""


class SkillPolicy:
    """A learned skill among the thesis's policies: it moves the joints itself, and says so by `command`.

    Attributes:
        phase: See `Policy`.
        command: The joint command of the last step. Shape (2, n).
    """

    def __init__(self, task: Task, learned: LearnedSkill, commands: JointController) -> None:
        """Make a policy of a skill.

        Args:
            task: Defend or home.
            learned: Plays it.
            commands: The rule-based player's controller: every command starts from its state and ends there.
        """
        self._task, self._learned, self._commands = task, learned, commands
        self.start()

    def start(self) -> None:
        """See `Policy.start`."""
        self._learned.start()
        self.phase = "learned"

    def step(self, view: View) -> Move:
        """See `Policy.step`."""
        state, atacom = self._commands.state, self._learned.controller
        atacom.reset(state.position, state.velocity)
        if self._learned.resting and self._comes_again(view):
            self._learned.start()
        self.command = self._learned.step(Situation(view.puck.state, view.tip, view.tip_velocity))
        self._commands.reset(*self.command)
        self.phase = "rest" if self._learned.resting else "learned"
        return Move(view.tip, finished=self._learned.resting and self._over(view))

    def _comes_again(self, view: View) -> bool:
        """Whether a puck that was defended has bounced off something, and is on its way to the own goal once more."""
        coming = view.puck.velocity[0] < -SLOW and view.puck.position[0] - view.tip[0] > CONTACT
        return self._task is Task.DEFEND and bool(coming)

    def _over(self, view: View) -> bool:
        """Whether the next task may begin: after a defence only when the puck is out of the way."""
        if self._task is Task.HOME:
            return True
        ahead = float(view.puck.position[0] - view.tip[0])
        leaving = view.puck.velocity[0] > 0.0 and ahead > _AWAY
        return view.puck.speed < _STILL or leaving or ahead < 0.0


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
            self._policies[task] = SkillPolicy(task, learned, self._controller)
        self.reset()

    def draw_action(self, observation: Array) -> Array:
        """See `AgentBase.draw_action`."""
        if self._first:
            self._controller.reset(self.get_joint_pos(observation))
            self._first = False
        view = self._view(observation)
        policy = self._policies[self._choose(view)]
        move = policy.step(view)
        self._finished = move.finished
        self.phase = f"{self._machine.state} {policy.phase}"
        return (
            policy.command
            if isinstance(policy, SkillPolicy)
            else self._controller.step(to_robot(move.target), move.velocity)
        )
