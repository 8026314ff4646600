"""`planner`: the planning player. It keeps track of the puck, chooses a skill and lets it act."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from airhockey.agents.base import AgentBase, Array, task_of
from airhockey.agents.control.joint_controller import JointController
from airhockey.agents.control.kinematics import ArmKinematics, spec_of
from airhockey.agents.control.workspace import Workspace
from airhockey.agents.estimation.kalman import Noise, PuckEstimate
from airhockey.agents.estimation.side_clock import HURRY, SideClock
from airhockey.agents.estimation.watch import TableWatch
from airhockey.agents.planner.estimation.choice import Arms
from airhockey.agents.planner.estimation.outcome import Outcome
from airhockey.agents.planner.estimation.table_learning import TableLearning
from airhockey.agents.planner.shots.kinds import ANY, KINDS, OPEN
from airhockey.agents.planner.skills.dead_puck import DeadPuck
from airhockey.agents.planner.skills.defend import Defend
from airhockey.agents.planner.skills.prepare import Prepare
from airhockey.agents.planner.skills.ready import Ready
from airhockey.agents.planner.skills.repel import Repel
from airhockey.agents.planner.skills.smash import Smash
from airhockey.agents.planner.tactics import Playing, choose
from airhockey.agents.skill import Situation, Skill
from airhockey.agents.table import to_table

TASKS = ("hit", "defend", "prepare")
"""Tasks of one episode each: too short to learn from."""
WARM_UP_STEPS = 60
"""Per skill and puck."""
EXPECTED = {
    "open": 0.05, "corner": 0.03, "near rim": 0.1, "far rim": 0.08, "middling near rim": 0.07, "middling far rim": 0.04,
    "double rim": 0.02, "triple rim": 0.03, "slow rim": 0.07, "slowest rim": 0.1, "rolling corner": 0.01, "drop": 0.01,
}  # fmt: skip
"""Points per try that a game begins with: the mean over keepers. Each fails against one kind or two, which then bring a quarter
to a half, and hardly ever against the others."""
ANSWERS = {"repel": 0.01, "defend": 0.08}
"""The same for the answers to a puck that comes."""
ANSWER_TRIES = 6.0
"""How many tries those are worth."""
TRIES = 2.5
"""How many tries these expectations are worth: few, so that a kind that a keeper does not know is found, and kept, at once."""
IN_VAIN = 0.3
"""Time for which a stroke of the kind chosen is looked for, in [s]; then another is chosen."""
RETURNED = 0.3
"""Speed towards the opponent at which a puck was knocked back, in [m]/[s]."""
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
        self._clock = SideClock(self._dt)
        self._task = task_of(env_info)
        self._smash, self._drop = Smash(env_info), DeadPuck(env_info)
        self._kinds = {kind.name: kind for kind in KINDS}
        self._strokes, self._answers = Arms(EXPECTED, TRIES), Arms(ANSWERS, ANSWER_TRIES)
        self._outcome, self._answered = Outcome(), Outcome()
        self._table = TableLearning()
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
        self._outcome.serve()
        self._answered.serve()
        self._intent: str | None = None
        self._vain: set[str] = set()
        self._looked, self._answer, self._repelling = 0.0, "defend", False
        self._watch.reset()
        self._smash.forget()
        self._drop.forget()
        self._skill: Skill | None = None
        self._step = 0
        self._clock.reset()
        self._table.reset()
        self._smash.play_on(self._table)

    def draw_action(self, observation: Array) -> Array:
        """See `AgentBase.draw_action`."""
        if self._step == 0:  # joints are observed once; afterwards the commands are the joints
            self._controller.reset(self.get_joint_pos(observation))
        situation = self._look(observation)
        skill = self._choose(situation)
        self._step += 1
        before = skill.phase
        action = skill.act(situation)
        self._learn(situation, skill, before)
        self._drop.watch(situation)
        self.phase = f"{skill.name} {skill.phase}"
        return action

    def _learn(self, situation: Situation, skill: Skill, before: str) -> None:
        """Note what the table is like, what was played, and what has become of it."""
        if self._task not in TASKS:
            self._table.see(situation)
            self._smash.play_on(self._table)
        x = float(situation.puck.position[0])
        for arm, points in self._outcome.see(x, situation.dt):
            self._strokes.tell(arm, points)
        for arm, points in self._answered.see(x, situation.dt):
            self._answers.tell(arm, points)
        if before == "strike" and skill.phase == "recover":
            self._outcome.struck("drop" if skill is self._drop else self._smash.kind.name)
            self._answered.struck("defend")
            self._intent = None
        self._repelling = self._repelling or (skill.name == "repel" and skill.phase == "catch")
        if self._repelling and situation.puck.velocity[0] > RETURNED:
            self._answered.struck("repel")
            self._repelling = False

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
        playing = Playing(name, finished, committed)
        if name not in ("defend", "repel"):
            self._answer = "defend" if self._task == "hit" else self._answers.draw() or "defend"
        stroke = self._stroke(situation)
        skill = self._skills[choose(self._task, playing, stroke, self._answer, situation)]
        if skill is not before:
            skill.begin(situation)
            self._skill = skill
        return skill

    def _stroke(self, situation: Situation) -> str | None:
        """The skill that has a stroke worth trying: in a game, of the kind that is to be tried next, or any before long."""
        if self._task in ("defend", "prepare"):
            return None
        if self._task == "hit":
            return "smash" if self._smash.scout(situation) is not None else None
        if situation.puck.position[0] > 0.0:
            self._intent = None
            self._vain.clear()
            return None
        if situation.held > HURRY:
            return self._any_stroke(situation)
        if self._intent is None:
            self._intent, self._looked = self._strokes.draw(self._vain) or OPEN.name, 0.0
        found = self._stroke_of(self._intent, situation)
        self._looked = 0.0 if found else self._looked + situation.dt
        if self._looked > IN_VAIN:
            self._vain.add(self._intent)
            self._intent = None
        return found

    def _stroke_of(self, intent: str, situation: Situation) -> str | None:
        if intent == "drop":
            return "drop" if self._drop.scout(situation) is not None else None
        self._smash.aim_for(self._kinds[intent])
        return "smash" if self._smash.scout(situation) is not None else None

    def _any_stroke(self, situation: Situation) -> str | None:
        """A shot of any worth, or else a roll: what sends the puck away before the time is up."""
        self._smash.aim_for(ANY)
        if self._smash.scout(situation) is not None:
            return "smash"
        return "drop" if self._drop.scout(situation) is not None else None

    def _look(self, observation: Array) -> Situation:
        return self._situation(*self._watch.see(observation, self._controller.tip_position()), self._step)

    def _situation(self, puck: PuckEstimate, tip: Array, opponent: Array | None, step: int) -> Situation:
        controller = self._controller
        return Situation(
            puck, tip, controller.tip_velocity(), opponent, self._dt, step, controller.move, controller.state.position,
            self._clock.see(float(puck.state[0])),
        )  # fmt: skip
