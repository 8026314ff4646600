import numpy as np
from air_hockey_challenge.framework import AgentBase


class Sway(AgentBase):
    """Sways about where it stands."""

    def __init__(self, env_info, width=0.02, **kwargs):
        super().__init__(env_info, **kwargs)
        self.width = width

    def reset(self):
        self.start, self.step = None, 0

    def draw_action(self, observation):
        if self.start is None:
            self.start = self.get_joint_pos(observation)
        self.step += 1
        phase = 0.1 * self.step
        sway = self.width * np.sin(phase) * np.ones_like(self.start)
        speed = self.width * 5.0 * np.cos(phase) * np.ones_like(sway)
        return np.stack((self.start + sway, speed, -25.0 * sway))
