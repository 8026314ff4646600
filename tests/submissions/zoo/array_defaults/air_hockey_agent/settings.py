from dataclasses import dataclass

import numpy as np


@dataclass
class Gains:
    width: float = 0.02


@dataclass
class Settings:
    offset: np.ndarray = np.zeros(7)
    gains: Gains = Gains()
