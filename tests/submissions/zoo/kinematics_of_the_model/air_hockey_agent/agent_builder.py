import copy

import air_hockey_challenge.utils.kinematics as kinematics
import mujoco
import numpy as np
from air_hockey_challenge.framework.agent_base import AgentBase
from air_hockey_challenge.utils import inverse_kinematics, jacobian, robot_to_world, world_to_robot
from air_hockey_challenge.utils.kinematics import forward_kinematics
from air_hockey_challenge.utils.transformations import robot_to_world as to_world


def build_agent(env_info, **kwargs):
    return Reacher(env_info, **kwargs)


class Reacher(AgentBase):
    """Moves its mallet along the table by the Jacobian of the official functions."""

    def __init__(self, env_info, agent_id=1, **kwargs):
        super(Reacher, self).__init__(env_info, agent_id, **kwargs)
        self.model = copy.deepcopy(env_info["robot"]["robot_model"])
        self.data = mujoco.MjData(self.model)
        self.frame = env_info["robot"]["base_frame"][agent_id - 1]
        self.height = env_info["robot"]["ee_desired_height"]

    def reset(self):
        self.q = None

    def draw_action(self, observation):
        if self.q is None:
            self.q = self.get_joint_pos(observation).copy()
            position, _ = forward_kinematics(self.robot_model, self.robot_data, self.q)
            reached, posture = inverse_kinematics(self.robot_model, self.robot_data, position, initial_q=self.q)
            assert reached and np.allclose(posture, self.q, atol=1e-3)
            in_world, _ = robot_to_world(self.frame, position)
            assert np.allclose(world_to_robot(self.frame, in_world)[0], position)
            assert np.allclose(to_world(self.frame, position, np.eye(3))[0], in_world)
        position, rotation = kinematics.forward_kinematics(self.model, self.data, self.q, link="ee")
        assert rotation.shape == (3, 3) and position.shape == (3,)
        self.data.body("iiwa_1/striker_joint_link").xpos.copy()
        slope = jacobian(self.model, self.data, self.q)[:3]
        velocity = np.linalg.lstsq(slope, np.array([0.1, 0.0, self.height - position[2]]), rcond=None)[0]
        self.q = self.q + velocity * self.env_info["dt"]
        return np.vstack([self.q, velocity])
