"""The defend task: stop a puck that comes, without bouncing it back (thesis 4.2.2).

The end-effector goes to a point of the defend line. With "top" where it is above the puck and "bottom" where it is
below:

    y_target = y_puck ± θ0 (r_puck + r_mallet) ‖v_puck‖ / 2        (+ top, − bottom)
    δx = θ1 + θ2 ‖v_puck‖ (x_target − x_ee),   δy = θ3 + θ4 ‖v_puck‖ (y_target − y_ee)

With `predict`, y_puck is the puck's where it will cross the line, and shortly before it arrives the end-effector
gives way along the puck's path ("cushion"): a puck that meets a mallet moving with the share e/(1 + e) of its own
velocity is left standing.
"""

from dataclasses import dataclass, field
from math import hypot

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.estimation.prediction import Crossing
from airhockey.agents.skill import Situation
from airhockey.agents.table import CONTACT
from airhockey.agents.thesis.polar import limited_step, stoppable_step
from airhockey.agents.thesis.policy import Move

Array = NDArray[np.float64]


@dataclass(frozen=True)
class DefendParameters:
    """What can be tuned about the defence.

    Attributes:
        theta: θ0, θ1 [m], θ2 [s]/[m], θ3 [m], θ4 [s]/[m].
        defend_line: x_target, in the table frame, in [m].
        predict: Use the puck's predicted y on the line instead of its present one, and give way.
        cushion: Share of the puck's velocity that the end-effector has when they meet.
        ramp: Time in which it takes up that velocity, in [s].
        acceleration: With which the end-effector can stop at the line, in [m]/[s²].
        longest_step: Of the end-effector, in [m].
        horizon: How far ahead a crossing is looked for, in [s].
        done_speed: A puck slower than this, in [m]/[s], is defended.
    """

    theta: tuple[float, ...] = field(metadata={"length": 5})
    defend_line: float
    predict: bool
    cushion: float
    ramp: float
    acceleration: float
    longest_step: float
    horizon: float
    done_speed: float


def y_target(theta: tuple[float, ...], y_puck: float, speed: float, from_top: bool) -> float:
    """Where to intercept the puck on the line, in [m]."""
    offset = theta[0] * CONTACT * speed / 2.0
    return y_puck + offset if from_top else y_puck - offset


def deltas(theta: tuple[float, ...], speed: float, target: Array, tip: Array) -> Array:
    """δx and δy, in [m]. Shape (2,)."""
    way = target - tip
    return np.array([theta[1] + theta[2] * speed * way[0], theta[3] + theta[4] * speed * way[1]])


class DefendPolicy:
    """Phases top and bottom, and cushion."""

    def __init__(self, parameters: DefendParameters) -> None:
        self._parameters = parameters
        self.start()

    def start(self) -> None:
        """See `Policy.start`."""
        self.phase = "wait"

    def step(self, now: Situation) -> Move:
        """See `Policy.step`."""
        p, puck = self._parameters, now.puck
        behind = puck.position[0] < now.tip[0]
        if puck.speed < p.done_speed or puck.velocity[0] > 0.0 or behind:
            return Move(now.tip, finished=True)
        crossing = now.puck_at_line(p.defend_line, p.horizon) if p.predict else None
        if crossing is not None and crossing.state[2] < 0:
            remaining = crossing.time - CONTACT / max(hypot(*crossing.state[2:4]), 1e-3)
            if remaining < p.ramp:
                return self._give_way(now, crossing, remaining)
        from_top = bool(now.tip[1] > puck.position[1])
        self.phase = "top" if from_top else "bottom"
        y_puck = float(puck.position[1]) if crossing is None else float(crossing.state[1])
        target = np.array([p.defend_line, y_target(p.theta, y_puck, puck.speed, from_top)])
        if crossing is not None:  # start in front of the line, to have gathered way on it
            target -= 0.5 * p.cushion * p.ramp * crossing.state[2:4]
        step = now.tip + deltas(p.theta, puck.speed, target, now.tip)
        longest = min(p.longest_step, stoppable_step(now.tip, target, p.acceleration, now.dt))
        return Move(limited_step(now.tip, step, longest))

    def _give_way(self, now: Situation, crossing: Crossing, remaining: float) -> Move:
        """Move with the puck: at the time of contact the end-effector is on the line and as fast as it should be."""
        p = self._parameters
        self.phase = "cushion"
        velocity = p.cushion * crossing.state[2:4]
        left = max(remaining - now.dt, 0.0)  # at the end of the coming step
        share = 1.0 - left / p.ramp
        way = velocity * (left - left**2 / (2.0 * p.ramp))  # still to go to the line
        return Move(crossing.state[:2] - way, velocity=share * velocity)
