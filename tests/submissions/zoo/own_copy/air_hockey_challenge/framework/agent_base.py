"""The team's copy of the challenge's package, as it was checked out: what it would do if it were used is tell."""

raise ImportError("the copy that says nothing new was used")


class AgentBase:
    def __init__(self, env_info, agent_id=1, **kwargs):
        pass

    def reset(self):
        pass

    def draw_action(self, observation):
        pass
