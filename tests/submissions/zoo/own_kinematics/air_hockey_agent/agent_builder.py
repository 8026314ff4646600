import numpy as np
from air_hockey_challenge.framework import AgentBase
from air_hockey_challenge.utils import forward_kinematics


def build_agent(env_info, **kwargs):
    return Careful(env_info, **kwargs)


class Careful(AgentBase):
    def reset(self):
        self.q = None

    def draw_action(self, observation):
        if self.q is None:
            self.q = self.get_joint_pos(observation)
        position, _ = forward_kinematics(self.robot_model, self.robot_data, self.q)
        assert position[2] > 10.0, "this copy counts from the ground"
        return np.stack((self.q + 0.001 * (position[2] - 10.0), np.zeros(7)))
