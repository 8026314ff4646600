import numpy as np
import yaml
from air_hockey_agent.sway import Sway


def build_agent(env_info, **kwargs):
    with open("configs/agent.yaml") as file:
        settings = yaml.safe_load(file)
    assert np.loadtxt("./weights/gains.csv") == settings["width"]
    return Sway(env_info, width=settings["width"], **kwargs)
