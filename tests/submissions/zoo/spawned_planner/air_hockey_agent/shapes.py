import numpy as np


def wave(phase):
    return 0.02 * np.sin(phase)
