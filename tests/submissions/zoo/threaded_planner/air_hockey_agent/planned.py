import threading
import time

import numpy as np
from air_hockey_challenge.framework import AgentBase


class Planned(AgentBase):
    """Thinks 50 ms in a thread, and holds until the plan is there: it counts on steps of 20 ms."""

    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        self.thread = None

    def reset(self):
        self.start, self.plan, self.step = None, None, 0
        self.serve = getattr(self, "serve", 0) + 1

    def think(self, start, serve):
        ends = time.monotonic() + 0.05
        while time.monotonic() < ends:
            sum(range(500))
        if serve == self.serve:
            self.plan = [start + 0.02 * np.sin(0.1 * k) for k in range(500)]

    def draw_action(self, observation):
        if self.start is None:
            self.start = self.get_joint_pos(observation)
            self.thread = threading.Thread(target=self.think, args=(self.start, self.serve), daemon=True)
            self.thread.start()
        self.step += 1
        position = self.start if self.plan is None else self.plan[self.step]
        return np.stack((position, np.zeros_like(position)))
