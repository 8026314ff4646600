import numpy as np
from air_hockey_challenge.framework import AgentBase


class Plain(AgentBase):
    def __init__(self, env_info, width=0.02, **kwargs):
        super().__init__(env_info, **kwargs)
        self.width = width

    def reset(self):
        self.start, self.step = None, 0

    def draw_action(self, observation):
        if self.start is None:
            self.start = self.get_joint_pos(observation)
        self.step += 1
        sway = self.width * np.sin(0.1 * self.step) * np.ones_like(self.start)
        return np.stack((self.start + sway, 5.0 * self.width * np.cos(0.1 * self.step) * np.ones_like(sway)))


class Sway(Plain):
    def draw_action(self, observation):
        from air_hockey_agent.fast import swayed

        return swayed(super().draw_action(observation))


def build_agent(env_info, **kwargs):
    return Sway(env_info, **kwargs)
