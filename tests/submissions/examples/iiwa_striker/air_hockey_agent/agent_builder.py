import os

from air_hockey_agent.agents.striker import Striker


def build_agent(env_info, look_ahead=0.0, **kwargs):
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "agents", "striker.msh")
    agent = Striker.load_agent(path, env_info, kwargs.get("agent_id", 1))
    agent.look_ahead = look_ahead
    return agent
