"""The default-position task: back to home on a curve (thesis 4.2.4), clear of the puck.

With β around the target point, counter-clockwise from the x axis, (4.14) to (4.16):

    correction = 360 − β  (y_target_point ≥ 0),  β − 0.01  (y_target_point < 0)
    dβ = (θ0 + θ1 dt) correction,   ds = step_size

y_target_point is the target seen from the end-effector: below the target it turns counter-clockwise (β grows to 360),
above it clockwise (β shrinks to 0.01), always the shorter way to arrive from the front.
"""

from dataclasses import dataclass
from math import hypot

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.skill import Situation
from airhockey.agents.table import CONTACT, HOME
from airhockey.agents.thesis.polar import Polar, cartesian, limited_step, polar
from airhockey.agents.thesis.policy import Move

Array = NDArray[np.float64]


@dataclass(frozen=True)
class HomeParameters:
    """What can be tuned about the way home.

    Attributes:
        step_size: ds, in [m].
        longest_step: Of the end-effector, in [m].
        arrived: Distance from home that counts as home, in [m].
        clearance: Gap between mallet and puck that is kept on the way, in [m].
        curved: On the curve of (4.14) to (4.16); otherwise straight, as before the thesis had them (tables 5.4 and 5.5).
    """

    step_size: float
    longest_step: float
    arrived: float
    clearance: float
    curved: bool = True


def correction(beta: float, y_target_point: float) -> float:
    """(4.14), in [°]."""
    return 360.0 - beta if y_target_point >= 0 else beta - 0.01


def d_beta(theta: tuple[float, ...], dt: float, correction_now: float) -> float:
    """(4.15), in [°]; θ are those of the hit."""
    return (theta[0] + theta[1] * dt) * correction_now


class HomePolicy:
    """Goes to a point, by default home, and stays there."""

    def __init__(self, parameters: HomeParameters, theta: tuple[float, ...], target_point: Array = HOME) -> None:
        self._parameters, self._theta, self._target = parameters, theta, target_point
        self.start()

    def start(self) -> None:
        """See `Policy.start`."""
        self.phase = "return"

    def step(self, now: Situation) -> Move:
        """See `Policy.step`. Home is finished once it is reached, and stays so."""
        p = self._parameters
        here = polar(self._target, now.tip)
        if here.radius < p.arrived:
            self.phase = "arrived"
            return Move(self._keep_clear(now, limited_step(now.tip, self._target, 0.1 * here.radius)), finished=True)
        self.phase = "return"
        if not p.curved:
            return Move(limited_step(now.tip, self._target, p.longest_step))
        below = float(self._target[1] - now.tip[1])
        turn = d_beta(self._theta, now.dt, correction(here.beta, below))
        beta = here.beta + turn if below >= 0 else here.beta - turn
        target = cartesian(self._target, Polar(beta, max(here.radius - p.step_size, 0.0)))
        return Move(limited_step(now.tip, self._keep_clear(now, target), p.longest_step))

    def _keep_clear(self, now: Situation, target: Array) -> Array:
        """The target, pushed out of the circle round the puck that the mallet's centre must not enter. Shape (2,)."""
        near = CONTACT + self._parameters.clearance
        ahead = now.puck.position + now.dt * now.puck.velocity
        away = target - ahead
        distance = hypot(*away.tolist())
        if distance >= near:
            return target
        outwards = away if distance > 1e-6 else now.tip - ahead
        return np.asarray(ahead + outwards * (near / max(hypot(*outwards), 1e-6)))
