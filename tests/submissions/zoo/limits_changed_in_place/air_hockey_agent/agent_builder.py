import numpy as np
from air_hockey_challenge.framework import AgentBase


class Careful(AgentBase):
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


def build_agent(env_info, **kwargs):
    env_info["robot"]["joint_vel_limit"] *= 0.9
    env_info["robot"]["joint_pos_limit"][0] += 0.05
    env_info["robot"]["joint_pos_limit"][1] -= 0.05
    env_info["puck"]["radius"] += 0.002
    env_info["new_vel_limit"] = env_info["robot"]["joint_vel_limit"][1] * 0.5
    for name in env_info["constraints"].keys():
        env_info["constraints"].get(name).fun(np.zeros(7), np.zeros(7))
    env_info["rl_info"].horizon = 1000
    return Careful(env_info, **kwargs)
