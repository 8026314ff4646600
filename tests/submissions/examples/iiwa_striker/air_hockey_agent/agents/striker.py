"""Moves the mallet towards a line before the puck with learnt gains, within the constraints."""

import numpy as np
import torch
from air_hockey_challenge.constraints import ConstraintList, EndEffectorConstraint, JointPositionConstraint
from air_hockey_challenge.framework.agent_base import AgentBase
from air_hockey_challenge.utils.kinematics import forward_kinematics, jacobian


class Striker(AgentBase):
    def __init__(self, env_info, agent_id=1, **kwargs):
        super().__init__(env_info, agent_id, **kwargs)
        self.gains = np.array([2.0, 2.0, 4.0])
        self.network = torch.nn.Linear(4, 2)
        self.look_ahead = 0.0
        self._add_save_attr(gains="numpy", network="torch", look_ahead="primitive")

    def reset(self):
        self.position = None
        self.velocity = np.zeros(7)
        self.checked = ConstraintList()
        self.checked.add(JointPositionConstraint(self.env_info))
        self.checked.add(EndEffectorConstraint(self.env_info))

    def draw_action(self, observation):
        if self.position is None:
            self.position = self.get_joint_pos(observation)
        puck_position, puck_velocity = self.get_puck_state(observation)
        puck = puck_position[:2] + self.look_ahead * puck_velocity[:2]
        seen = torch.tensor(np.concatenate((puck, puck_velocity[:2])), dtype=torch.float32)
        with torch.no_grad():
            trim = 0.05 * np.tanh(self.network(seen).numpy().astype(np.float64))
        height = self.env_info["robot"]["ee_desired_height"]
        target = np.array([0.75 + trim[0], np.clip(0.5 * puck[1], -0.25, 0.25) + trim[1], height])
        here, _ = forward_kinematics(self.robot_model, self.robot_data, self.position)
        wanted = np.clip(self.gains * (target - here), -0.3, 0.3)
        slope = jacobian(self.robot_model, self.robot_data, self.position)[:3]
        velocity = slope.T @ np.linalg.solve(slope @ slope.T + 1e-4 * np.eye(3), wanted)
        velocity *= self.slow_down(velocity)
        velocity = 0.8 * self.velocity + 0.2 * velocity
        acceleration = (velocity - self.velocity) / self.env_info["dt"]
        self.velocity = velocity
        self.position = self.position + velocity * self.env_info["dt"]
        return np.stack((self.position, velocity, acceleration))

    def slow_down(self, velocity):
        """Less where the next step would leave the limits."""
        after = self.position + velocity * self.env_info["dt"]
        own = self.checked.fun(after, velocity)
        official = self.env_info["constraints"]
        assert set(own) <= set(official.keys())
        worst = max(own["joint_pos_constr"].max(), official.get("joint_vel_constr").fun(after, velocity).max())
        slope = official.get("ee_constr").jacobian(after, velocity)
        assert slope.shape == (5, 14)
        return 0.5 if worst > 0.0 else 1.0
