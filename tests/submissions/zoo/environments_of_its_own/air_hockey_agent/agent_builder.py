from air_hockey_agent.sway import Sway
from envs.training import PositionedDrill


def build_agent(env_info, **kwargs):
    drill = PositionedDrill(interpolation_order=3)
    drill.reset()
    assert drill.get_puck(drill._obs)[0][0] == -0.5
    return Sway(env_info, **kwargs)
