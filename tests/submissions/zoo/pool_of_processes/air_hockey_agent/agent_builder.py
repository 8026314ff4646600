import numpy as np
from air_hockey_challenge.framework import AgentBase


class Sway(AgentBase):
    def reset(self):
        self.start, self.step = None, 0

    def draw_action(self, observation):
        if self.start is None:
            self.start = self.get_joint_pos(observation)
        self.step += 1
        sway = self.width * np.sin(0.1 * self.step) * np.ones_like(self.start)
        return np.stack((self.start + sway, 5.0 * self.width * np.cos(0.1 * self.step) * np.ones_like(sway)))

    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        from concurrent.futures import ProcessPoolExecutor
        from multiprocessing import Pool

        from air_hockey_agent.work import square

        self.square = square
        self.executor = ProcessPoolExecutor(2)
        with Pool(2) as pool:
            self.width = 0.02 * sum(pool.map(square, [0.6, 0.8]))

    def episode_start(self):
        super().episode_start()
        self.width = 0.02 * self.executor.submit(self.square, -1.0).result()


def build_agent(env_info, **kwargs):
    return Sway(env_info, **kwargs)
