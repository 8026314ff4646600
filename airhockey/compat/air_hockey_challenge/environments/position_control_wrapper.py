"""Base environments whose actions are set-points, interpolated and tracked by the challenge's joint controller."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.compat.base_environments import BaseEnvironment

from . import iiwas, planar

Array = NDArray[np.float64]


class PositionControl(BaseEnvironment):
    """A base environment with the challenge's control step: limiter, feed-forward, joint controller, universal joint.

    Args:
        interpolation_order: 1, 2, 3, 4, 5, -1 or None; with two players also a pair of them.

    Attributes:
        jerk: Of the latest step; see the challenge's `info`.
    """

    def __init__(self, interpolation_order: Any = 3, debug: bool = False, **kwargs: Any) -> None:
        self._order = tuple(interpolation_order) if isinstance(interpolation_order, list) else interpolation_order
        super().__init__(**kwargs)
        self.jerk = np.zeros(self._n)

    def _advance(self, action: Any) -> None:
        *_, info = self._env.step(action)
        self.jerk = info["jerk"]

    def _settle(self) -> None:
        """Let the controller begin from what MuJoCo's data hold now."""
        puck = self._data.qpos[-3:].copy(), self._data.qvel[-3:].copy()
        self._env.simulation.reset(*puck, self._joint_values("qpos"), self._joint_values("qvel"))

    def _create_observation(self) -> Array:
        return self._env.base_observation


class PositionControlIIWA(PositionControl):
    """With the gains of the iiwa."""


class PositionControlPlanar(PositionControl):
    """With the gains of the planar robot."""


class PlanarPositionHit(PositionControlPlanar, planar.AirHockeyHit):
    """3dof-hit."""


class PlanarPositionDefend(PositionControlPlanar, planar.AirHockeyDefend):
    """3dof-defend."""


class IiwaPositionHit(PositionControlIIWA, iiwas.AirHockeyHit):
    """7dof-hit; the other robot moves by itself."""


class IiwaPositionDefend(PositionControlIIWA, iiwas.AirHockeyDefend):
    """7dof-defend."""


class IiwaPositionPrepare(PositionControlIIWA, iiwas.AirHockeyPrepare):
    """7dof-prepare."""


class IiwaPositionTournament(PositionControlIIWA, iiwas.AirHockeyTournament):
    """The tournament's scene, with a pair of actions."""
