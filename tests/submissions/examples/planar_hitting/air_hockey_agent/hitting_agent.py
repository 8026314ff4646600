"""Waits, plans a straight stroke through the puck, optimises the joint trajectory, and plays it back."""

import numpy as np
from air_hockey_challenge.framework import AgentBase
from air_hockey_challenge.utils import inverse_kinematics, world_to_robot

from .trajectory_optimizer import TrajectoryOptimizer


class HittingAgent(AgentBase):
    def __init__(self, env_info, hit_speed=0.5, **kwargs):
        super().__init__(env_info, **kwargs)
        self.hit_speed = hit_speed
        self.optimizer = TrajectoryOptimizer(env_info, self.robot_model, self.robot_data)
        goal = np.array([env_info["table"]["length"] / 2, 0.0, 0.0])
        self.goal = world_to_robot(env_info["robot"]["base_frame"][0], goal)[0][:2]
        self.commands = []
        self.waited = 0
        self.last_command = None

    def reset(self):
        self.commands = []
        self.waited = 0
        self.last_command = None

    def draw_action(self, observation):
        if self.last_command is None:
            self.last_command = np.stack((self.get_joint_pos(observation), np.zeros(3)))
        if self.waited == 10:
            self.commands = self.plan(observation)
        self.waited += 1
        if self.commands:
            self.last_command = self.commands.pop(0)
        else:
            self.last_command = np.stack((self.last_command[0], np.zeros(3)))
        return self.last_command

    def plan(self, observation):
        puck = self.get_puck_pos(observation)[:2]
        here = self.get_ee_pose(observation)[0][:2]
        direction = (self.goal - puck) / np.linalg.norm(self.goal - puck)
        reach = self.env_info["puck"]["radius"] + self.env_info["mallet"]["radius"]
        contact = puck - reach * direction
        reachable, q_contact = inverse_kinematics(
            self.robot_model, self.robot_data, contact, initial_q=self.get_joint_pos(observation)
        )
        if not reachable:
            return []
        duration = 2.0 * np.linalg.norm(contact - here) / self.hit_speed
        return self.optimizer.optimize(
            here, contact, direction * self.hit_speed, self.last_command[0], q_contact, duration
        )
