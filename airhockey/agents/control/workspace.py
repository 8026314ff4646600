"""Where the rod tip may be: inside the table's edges, seen in the robot frame."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.control.kinematics import spec_of
from airhockey.agents.control.parameters import control_parameters
from airhockey.envs.specs import MALLET, TABLE

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Workspace:
    """A rectangle in the robot frame, and how hard the rod tip may brake before its edges.

    Attributes:
        lower, upper: Corners, in [m]. Shapes (2,), (2,).
        acceleration: In [m]/[s²].
    """

    lower: Array
    upper: Array
    acceleration: float

    @classmethod
    def of(cls, env_info: Mapping[str, Any]) -> "Workspace":
        """The player's half of the table, less the mallet's radius and a margin at the edges."""
        spec = spec_of(env_info)
        parameters = control_parameters(spec)
        inset = MALLET.radius + parameters.edge_margin
        half = np.array([TABLE.length, TABLE.width]) / 2.0 - inset
        centre = np.array([-spec.base_positions[0][0], 0.0])
        return cls(centre - half, centre + np.array([0.0, half[1]]), parameters.tip_acceleration)
