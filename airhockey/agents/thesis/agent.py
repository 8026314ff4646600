"""`thesis`: the hierarchical rule-based player (thesis chapter 4) on either robot."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from airhockey.agents.base import AgentBase, Array, task_of
from airhockey.agents.control.joint_controller import JointController
from airhockey.agents.control.kinematics import ArmKinematics, spec_of
from airhockey.agents.control.parameters import control_parameters
from airhockey.agents.control.workspace import Workspace
from airhockey.agents.estimation.prediction import puck_predictor
from airhockey.agents.estimation.side_clock import SideClock
from airhockey.agents.estimation.watch import TableWatch
from airhockey.agents.skill import Situation, Skill
from airhockey.agents.thesis.defend import DefendPolicy
from airhockey.agents.thesis.hit import HitPolicy
from airhockey.agents.thesis.home import HomePolicy
from airhockey.agents.thesis.opponent import OpponentWatch
from airhockey.agents.thesis.parameters import ThesisParameters, thesis_parameters
from airhockey.agents.thesis.policy import Policy, RuleSkill
from airhockey.agents.thesis.prepare import PreparePolicy
from airhockey.agents.thesis.state_machine import StateMachine, Task
from airhockey.agents.thesis.switcher import Switcher

TASKS = {
    "hit": frozenset({Task.HIT, Task.PREPARE}),
    "defend": frozenset({Task.DEFEND}),
    "prepare": frozenset({Task.PREPARE}),
    "home": frozenset(),
    "tournament": frozenset({Task.HIT, Task.DEFEND, Task.PREPARE}),
}
"""What there is to do besides going home, by the last word of an environment's name."""


class ThesisAgent(AgentBase):
    """Switcher and state machine over four policies; joint commands by AQP; the puck filtered (4.2.5)."""

    def __init__(
        self,
        env_info: Mapping[str, Any],
        agent_id: int = 1,
        parameters: str | Path | ThesisParameters = "tuned",
        **kwargs: Any,
    ) -> None:
        """Build the player.

        Args:
            env_info: Description of the environment.
            agent_id: 1 or 2.
            parameters: "tuned", "thesis", the path of a YAML file, or the parameters themselves.
            kwargs: Ignored.

        Raises:
            ConfigurationError: The parameter file is not usable.
        """
        super().__init__(env_info, agent_id, **kwargs)
        p = thesis_parameters(parameters)
        self._dt = float(env_info["dt"])
        spec = spec_of(env_info)
        control = p.margins.within(control_parameters(spec))
        self._controller = JointController(ArmKinematics(spec), Workspace.of(env_info), self._dt, control)
        self._watch = TableWatch(env_info)
        self._clock = SideClock(self._dt)
        self._watches_clock = task_of(env_info) == "tournament" and p.switcher.hurry
        self._opponent = OpponentWatch(p.opponent_rate, self._dt)
        policies: dict[Task, Policy] = {
            Task.HOME: HomePolicy(p.home, p.hit.theta),
            Task.HIT: HitPolicy(p.hit, self._opponent),
            Task.DEFEND: DefendPolicy(p.defend),
            Task.PREPARE: (prepare := PreparePolicy(p.prepare)),
        }
        self._prepare = prepare
        self._skills: dict[Task, Skill] = {task: RuleSkill(task, policy) for task, policy in policies.items()}
        puck_predictor()  # compiles before the game
        tasks = TASKS.get(task_of(env_info), TASKS["tournament"])
        self._switcher = Switcher(p.switcher, tasks)
        self._early = p.switcher.leave_home_early
        self._machine = StateMachine(p.state_machine)
        self.reset()

    def reset(self) -> None:
        """See `AgentBase.reset`."""
        self._watch.reset()
        self._clock.reset()
        self._opponent.reset()
        self._machine.reset()
        self._switcher.reset()
        self._prepare.reset()
        self._first = True

    def draw_action(self, observation: Array) -> Array:
        """See `AgentBase.draw_action`."""
        if self._first:  # joints are observed once; afterwards the commands are the joints
            self._controller.reset(self.get_joint_pos(observation))
        now = self._look(observation)
        skill = self._choose(now)
        action = skill.act(now)
        self.phase = f"{self._machine.state} {skill.phase}"
        return action

    def _look(self, observation: Array) -> Situation:
        controller = self._controller
        puck, tip, opponent = self._watch.see(observation, controller.tip_position())
        self._opponent.see(opponent)
        held = self._clock.see(float(puck.state[0])) if self._watches_clock else 0.0
        return Situation(puck, tip, controller.tip_velocity(), opponent, self._dt, move=controller.move, held=held)

    def _choose(self, now: Situation) -> Skill:
        """The skill for this step, begun if it is another than before or had finished."""
        before = self._machine.state
        suggested = self._switcher.choose(now)
        at_home = before is Task.HOME and (self._early or suggested is Task.DEFEND)
        finished = not self._first and self._skills[before].finished
        task = self._machine.advance(suggested, finished or at_home)
        skill = self._skills[task]
        if self._first or finished or task is not before:
            skill.begin(now)
        self._first = False
        return skill
