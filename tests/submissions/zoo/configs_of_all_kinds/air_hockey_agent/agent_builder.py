import configparser
import json
import os
import pickle

import numpy as np
import yaml

from .sway import Sway

HERE = os.path.dirname(__file__)


def build_agent(env_info, gains=(), hit=None, note="", **kwargs):
    with open(os.path.join(HERE, "configs", "agent.yaml")) as file:
        width = yaml.load(file, Loader=yaml.FullLoader)["agent"]["width"]
    with open("air_hockey_agent/configs/agent.json", encoding="utf-8") as file:
        width *= json.load(file)["scale"][0]
    ini = configparser.ConfigParser()
    ini.read("air_hockey_agent/configs/agent.ini")
    width *= ini.getfloat("agent", "scale")
    parameters = pickle.loads(pickle.dumps({"scale": np.float64(1.0)}))
    assert gains == [1.0, 0.5] and hit == {"speed": 1.5, "angles": [0.1, -0.1]} and note == "first try: with a colon"
    return Sway(env_info, width=width * parameters["scale"] * gains[0], **kwargs)
