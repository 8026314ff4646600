"""`thesis`: the hierarchical rule-based player (thesis chapter 4) on either robot."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from airhockey.agents.base import AgentBase, Array
from airhockey.agents.control.joint_controller import JointController
from airhockey.agents.control.kinematics import ArmKinematics, spec_of
from airhockey.agents.control.parameters import control_parameters
from airhockey.agents.control.workspace import Workspace
from airhockey.agents.estimation.prediction import PuckPredictor
from airhockey.agents.estimation.watch import TableWatch
from airhockey.agents.table import to_robot, to_table
from airhockey.agents.thesis.defend import DefendPolicy
from airhockey.agents.thesis.hit import HitPolicy
from airhockey.agents.thesis.home import HomePolicy
from airhockey.agents.thesis.opponent import OpponentWatch
from airhockey.agents.thesis.parameters import ThesisParameters, thesis_parameters
from airhockey.agents.thesis.policy import Policy, View
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
        self._opponent = OpponentWatch(p.opponent_rate, self._dt)
        self._policies: dict[Task, Policy] = {
            Task.HOME: HomePolicy(p.home, p.hit.theta),
            Task.HIT: HitPolicy(p.hit, self._opponent),
            Task.DEFEND: DefendPolicy(p.defend, PuckPredictor()),
            Task.PREPARE: PreparePolicy(p.prepare),
        }
        tasks = TASKS.get(str(env_info["env_name"]).rpartition("-")[2], TASKS["tournament"])
        self._switcher = Switcher(p.switcher, tasks)
        self._early = p.switcher.leave_home_early
        self._machine = StateMachine()
        self.reset()

    def reset(self) -> None:
        """See `AgentBase.reset`."""
        self._watch.reset()
        self._opponent.reset()
        self._machine.reset()
        self._switcher.reset()
        self._policies[Task.HOME].start()
        self._finished = False
        self._first = True

    def draw_action(self, observation: Array) -> Array:
        """See `AgentBase.draw_action`."""
        if self._first:  # joints are observed once; afterwards the commands are the joints
            self._controller.reset(self.get_joint_pos(observation))
            self._first = False
        view = self._view(observation)
        task = self._choose(view)
        move = self._policies[task].step(view)
        self._finished = move.finished
        self.phase = f"{task} {self._policies[task].phase}"
        return self._controller.step(to_robot(move.target), move.velocity)

    def _view(self, observation: Array) -> View:
        tip = to_table(self._controller.tip_position())
        puck, opponent = self._watch.see(observation, tip)
        self._opponent.see(opponent)
        return View(puck, tip, self._controller.tip_velocity(), opponent, self._dt)

    def _choose(self, view: View) -> Task:
        before = self._machine.state
        suggested = self._switcher.choose(view)
        at_home = before is Task.HOME and (self._early or suggested is Task.DEFEND)
        task = self._machine.advance(suggested, self._finished or at_home)
        if self._finished or task is not before:
            self._policies[task].start()
        return task
