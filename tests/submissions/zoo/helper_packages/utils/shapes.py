import numpy as np


def wave(phase):
    return np.sin(phase)
