import os
import sys

sys.path.append("..")
sys.path.append(os.path.join(os.path.dirname(__file__), ".."))
sys.path.insert(0, os.path.join(os.getcwd(), "lib"))
sys.path.append("third_party")

import gain_of_lib  # noqa: E402
import gain_of_third_party  # noqa: E402

from .swaying import Sway  # noqa: E402
from .tools.files import read  # noqa: E402


def build_agent(env_info, **kwargs):
    width = gain_of_lib.GAIN * gain_of_third_party.GAIN
    texts = [read("air_hockey_agent/gain.txt"), read(os.path.join(os.getcwd(), "air_hockey_agent", "gain.txt"))]
    texts.append(read(os.path.join(os.path.dirname(os.path.realpath(__file__)), "gain.txt")))
    return Sway(env_info, width=width * float(texts[0]) * float(texts[1]) * float(texts[2]), **kwargs)
