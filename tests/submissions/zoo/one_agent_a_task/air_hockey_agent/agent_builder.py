from examples.control.sway import Sway


class Hit(Sway):
    pass


class Defend(Sway):
    pass


class Switcher(Sway):
    def __init__(self, env_info, **kwargs):
        super().__init__(env_info, **kwargs)
        self.agents = [Hit(env_info, **kwargs), Defend(env_info, **kwargs)]

    def reset(self):
        super().reset()
        for agent in self.agents:
            agent.reset()

    def draw_action(self, observation):
        return self.agents[int(observation[0] > 1.51)].draw_action(observation)


def build_agent(env_info, widths=None, **kwargs):
    agents = {"7dof-hit": Hit, "7dof-defend": Defend, "7dof-prepare": Hit, "tournament": Switcher}
    name = env_info["env_name"]
    return agents[name](env_info, width=widths[name], **kwargs)
