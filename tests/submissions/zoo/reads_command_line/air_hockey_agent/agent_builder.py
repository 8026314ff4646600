import argparse

import numpy as np
from air_hockey_challenge.framework import AgentBase

parser = argparse.ArgumentParser()
parser.add_argument("--step", type=float, default=0.001)
parser.add_argument("--device", default="cpu")
args = parser.parse_args()


def build_agent(env_info, **kwargs):
    return Walk(env_info, **kwargs)


class Walk(AgentBase):
    def reset(self):
        self.q = None

    def draw_action(self, observation):
        if self.q is None:
            self.q = self.get_joint_pos(observation)
        self.q = self.q + args.step
        return [self.q.tolist(), [0.0] * len(self.q)]
