"""`planner`: the planning player. It keeps track of the puck, chooses a skill and lets it act."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from airhockey.agents.base import AgentBase, Array
from airhockey.agents.control.joint_controller import JointController
from airhockey.agents.control.kinematics import ArmKinematics, spec_of
from airhockey.agents.control.workspace import Workspace
from airhockey.agents.estimation.kalman import Noise, PuckEstimate
from airhockey.agents.estimation.watch import TableWatch
from airhockey.agents.planner.estimation.shot_statistics import ShotStatistics
from airhockey.agents.planner.skills.dead_puck import DeadPuck
from airhockey.agents.planner.skills.defend import Defend
from airhockey.agents.planner.skills.prepare import Prepare
from airhockey.agents.planner.skills.ready import Ready
from airhockey.agents.planner.skills.repel import Repel
from airhockey.agents.planner.skills.smash import Smash
from airhockey.agents.planner.tactics import choose
from airhockey.agents.skill import Situation, Skill
from airhockey.agents.table import to_table

WARM_UP_STEPS = 60
"""Per skill and puck."""
NOISE = Noise(drift_velocity=0.001, drift_share=0.002)
"""A slow puck is almost undisturbed: long averages are what makes a strike accurate."""


class PlannerAgent(AgentBase):
    """Filter, choice of a skill, and the skill."""

    interpolation_order = 3

    def __init__(self, env_info: Mapping[str, Any], agent_id: int = 1, **kwargs: Any) -> None:
        """Build the player; every skill plans once here, so that nothing is slow in the game.

        Args:
            env_info: Description of the environment.
            agent_id: 1 or 2.
            kwargs: Ignored.
        """
        super().__init__(env_info, agent_id, **kwargs)
        self._dt = float(env_info["dt"])
        self._controller = JointController(ArmKinematics(spec_of(env_info)), Workspace.of(env_info), self._dt)
        self._watch = TableWatch(env_info, NOISE)
        self._task = str(env_info["env_name"]).rpartition("-")[2]
        self._smash, self._drop = Smash(env_info), DeadPuck(env_info)
        self._shots = ShotStatistics()
        self._skills: dict[str, Skill] = {
            "smash": self._smash,
            "drop": self._drop,
            "ready": Ready(env_info),
            "defend": Defend(env_info),
            "repel": Repel(env_info),
            "prepare": Prepare(env_info),
        }
        self._warm_up()
        self.reset()

    def reset(self) -> None:
        """See `AgentBase.reset`."""
        self._shots.serve()
        self._watch.reset()
        self._smash.forget()
        self._drop.forget()
        self._skill: Skill | None = None
        self._step = 0

    def draw_action(self, observation: Array) -> Array:
        """See `AgentBase.draw_action`."""
        if self._step == 0:  # joints are observed once; afterwards the commands are the joints
            self._controller.reset(self.get_joint_pos(observation))
        situation = self._look(observation)
        skill = self._choose(situation)
        self._step += 1
        striking = skill is self._smash and skill.phase == "strike"
        action = skill.act(situation)
        if striking and skill.phase == "recover":
            self._shots.struck()
        self._shots.wait(situation.dt)
        self._drop.watch(situation)
        self.phase = f"{skill.name} {skill.phase}"
        return action

    def _warm_up(self) -> None:
        """Let every skill act on some pucks: what is compiled or loaded at a first call must not be so in the game."""
        opponent = np.array([0.86, 0.0])
        for velocity in (np.zeros(2), np.array([-1.5, 0.3]), np.array([-0.2, 0.1])):
            for skill in self._skills.values():
                for step in range(WARM_UP_STEPS):
                    puck = np.concatenate([np.array([-0.5, 0.1]) - step * self._dt * velocity, velocity, np.zeros(1)])
                    estimate = PuckEstimate(puck, 1e-6 * np.eye(5), 0)
                    if step == 0:
                        self._controller.reset(np.array(self._controller.kinematics.spec.start))
                        self._smash.forget()
                    now = self._situation(estimate, to_table(self._controller.tip_position()), opponent, step)
                    if step == 0:
                        skill.begin(now)
                    self._smash.scout(now)
                    skill.act(now)

    def _choose(self, situation: Situation) -> Skill:
        """The skill for this step, begun if it is another than before or had finished."""
        before = self._skill
        name = before.name if before is not None else "ready"
        finished = before is None or before.finished
        committed = before is not None and getattr(before, "committed", False)
        stroke, patient = self._stroke(situation), self._shots.futile
        skill = self._skills[choose(self._task, name, finished, committed, stroke, patient, situation)]
        if skill is not before:
            skill.begin(situation)
            self._skill = skill
        return skill

    def _stroke(self, situation: Situation) -> str | None:
        """The skill that has a stroke worth trying: a shot at the goal or, in a game where those are futile, a drop."""
        if self._task in ("defend", "prepare"):
            return None
        if self._task != "hit" and self._shots.futile:
            return "drop" if self._drop.scout(situation) is not None else None
        return "smash" if self._smash.scout(situation) is not None else None

    def _look(self, observation: Array) -> Situation:
        return self._situation(*self._watch.see(observation, self._controller.tip_position()), self._step)

    def _situation(self, puck: PuckEstimate, tip: Array, opponent: Array | None, step: int) -> Situation:
        controller = self._controller
        return Situation(puck, tip, controller.tip_velocity(), opponent, self._dt, step, controller.move)
