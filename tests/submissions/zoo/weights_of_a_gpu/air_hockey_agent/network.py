import numpy as np
import torch
from air_hockey_challenge.framework import AgentBase


class Network(AgentBase):
    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        self.policy = torch.nn.Linear(3, 1)
        self.policy.load_state_dict(torch.load("weights/policy.pt"))

    def reset(self):
        self.start = None

    def draw_action(self, observation):
        if self.start is None:
            self.start = self.get_joint_pos(observation)
        with torch.no_grad():
            out = self.policy(torch.as_tensor(self.get_puck_pos(observation), dtype=torch.float32)).item()
        position = self.start + 0.01 * np.tanh(out)
        return np.stack((position, np.zeros_like(position)))
