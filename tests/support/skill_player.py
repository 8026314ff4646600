"""A player that does nothing but one skill."""

import numpy as np

from airhockey import envs
from airhockey.agents.control.joint_controller import JointController
from airhockey.agents.control.kinematics import ArmKinematics, spec_of
from airhockey.agents.control.workspace import Workspace
from airhockey.agents.estimation.kalman import PuckFilter
from airhockey.agents.skill import Situation
from airhockey.agents.table import CONTACT, to_table


class SkillPlayer:
    """Filters the puck and lets a skill act, in an environment of its own."""

    def __init__(self, environment, make_skill, disturbances="ideal"):
        self.env = envs.make(environment, disturbances=disturbances)
        info = self.env.env_info
        self.skill = make_skill(info)
        self.controller = JointController(ArmKinematics(spec_of(info)), Workspace.of(info), info["dt"])
        self.filter = PuckFilter(info["dt"])

    def situation(self, observation, step):
        info = self.env.env_info
        if step == 0:
            self.filter.reset()
            self.controller.reset(observation[info["joint_pos_ids"]])
        puck = np.array([*to_table(observation[info["puck_pos_ids"]]), 0.0])
        tip = to_table(self.controller.tip_position())
        near = np.hypot(*(puck[:2] - tip)) < CONTACT + 0.012
        estimate = self.filter.update(puck, observation[info["puck_vel_ids"]], bool(near))
        return Situation(
            estimate,
            tip,
            self.controller.tip_velocity(),
            None,
            info["dt"],
            step,
            self.controller.move,
            self.controller.state.position,
        )

    def play(self, seed):
        """One episode: the last info, whether any constraint was violated, and the last true state of the puck."""
        observation, violated = self.env.reset(seed=seed), False
        for step in range(self.env.horizon):
            now = self.situation(observation, step)
            if step == 0:
                self.skill.begin(now)
            observation, _, over, info = self.env.step(self.skill.act(now))
            violated |= any(value.max() > 0.0 for value in info["constraints_value"].values())
            if over:
                break
        return info, violated, self.env.base_observation[:6]
