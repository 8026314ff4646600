import numpy as np
from air_hockey_challenge.framework import AgentBase


class Sway(AgentBase):
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


class Listing(Sway):
    """Gives lists, tuples, single precision, tensors and arrays of another order."""

    def draw_action(self, observation):
        import torch

        action = super().draw_action(np.float32(observation))
        kinds = (
            lambda a: a.tolist(),
            lambda a: tuple(map(tuple, a)),
            lambda a: a.astype(np.float32),
            lambda a: torch.as_tensor(a),
            lambda a: np.asfortranarray(a),
            lambda a: list(a),
        )
        return kinds[self.step % len(kinds)](action)


def build_agent(env_info, **kwargs):
    return Listing(env_info, **kwargs)
