import numpy as np
from air_hockey_challenge.framework.agent_base import AgentBase


def build_agent(env_info, **kwargs):
    return DummyAgent(env_info, **kwargs)


class DummyAgent(AgentBase):
    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        self.new_start = True
        self.hold_position = None

    def reset(self):
        self.new_start = True
        self.hold_position = None

    def draw_action(self, observation):
        if self.new_start:
            self.new_start = False
            self.hold_position = self.get_joint_pos(observation)
        return np.vstack([self.hold_position, np.zeros_like(self.hold_position)])
