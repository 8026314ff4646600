import numpy as np


class Duck:
    next_action = None
    preprocessors = ()

    def __init__(self, env_info):
        self.ids = env_info["joint_pos_ids"]

    def episode_start(self):
        self.q = None

    def draw_action(self, observation):
        self.q = observation[self.ids] if self.q is None else self.q
        return [list(self.q), [0.0] * len(self.q)]


def build_agent(env_info, **kwargs):
    return Duck(env_info)
