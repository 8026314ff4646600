import os

from air_hockey_agent.agents.saved import Saved


def build_agent(env_info, **kwargs):
    here = os.path.dirname(os.path.abspath(__file__))
    return Saved.load_agent(os.path.join(here, "agents", "saved.msh"), env_info)
