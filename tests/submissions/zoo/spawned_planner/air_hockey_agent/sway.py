import multiprocessing

import numpy as np
from air_hockey_challenge.framework import AgentBase
from planning.worker import plan


class Planned(AgentBase):
    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        spawn = multiprocessing.get_context("spawn")
        self.requests, self.answers = spawn.Queue(), spawn.Queue()
        self.worker = spawn.Process(target=plan, args=(self.requests, self.answers), daemon=True)
        self.worker.start()

    def reset(self):
        self.start, self.step = None, 0

    def draw_action(self, observation):
        if self.start is None:
            self.start = self.get_joint_pos(observation)
        self.step += 1
        self.requests.put(0.1 * self.step)
        sway = self.answers.get(timeout=30.0)
        return np.stack((self.start + sway, np.zeros_like(self.start)))
