"""The prepare task: bring a puck that lies at a border to where it can be hit (thesis 4.2.3).

The end-effector goes round the puck to the side turned to the table's middle, and pushes: the puck leaves the border
by bouncing off it. Printed formulas (4.11) to (4.13), with β counter-clockwise from the x axis and t_phase in steps:

    dβ = θ0 t_phase + θ1 correction  (adjustment),  correction  (acceleration)
    ds = 5·10⁻³  (adjustment),  θ2  (acceleration)
    correction = β − 90  (y_puck ≤ 0),  270 − β  (y_puck > 0)

dβ counts towards the aim: below the middle β decreases by it, above it increases. The printed aim, 90° (270°), pushes
straight at the side rim. With `bank_shot` it turns: at the short rim behind the puck, or so that the bounce leads to
the middle.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.estimation.side_clock import HURRY
from airhockey.agents.skill import Situation
from airhockey.agents.table import CONTACT, HALF_LENGTH, HOME
from airhockey.agents.thesis.bank_shot import bank_aim, off_the_short_rim
from airhockey.agents.thesis.polar import Polar, cartesian, limited_step, polar, wrapped
from airhockey.agents.thesis.policy import TOLERANCE, Move, enough_space
from airhockey.envs.specs import PUCK

Array = NDArray[np.float64]

_STILL = 0.03
"""Speed below which a puck is at rest, in [m]/[s]."""
_STOPPED = 0.002
"""Way of a step below which the mallet has stopped, in [m]: noise moves its aim by a millimetre."""
_LEFT = 0.01
"""Way of the puck below which a push was in vain, in [m]."""


@dataclass(frozen=True)
class PrepareParameters:
    """What can be tuned about the preparation.

    Attributes:
        theta: θ0 [°], θ1, θ2 [m].
        approach: ds of the adjustment, in [m].
        wait_speed: The puck is waited for until it is slower, in [m]/[s].
        stand_off: Distance to the puck at which the push starts, in [m].
        aligned: Largest |correction| at which it starts, in [°].
        longest_step: Of the end-effector in the adjustment, in [m].
        side_tolerance, end_tolerance: Of `enough_space`, in [m].
        bank_shot: Aim by the bounce; otherwise straight at the side rim as printed.
        largest_tilt: Of a bank shot from the rim's normal, in [°].
        near_x, far_x: Where a bank shot leads the puck to, in the table frame, in [m].
        touch, touch_speed: Gap to the puck, in [m], and speed of the puck, in [m]/[s], that show that it was pushed.
        clearance: Gap that is kept from the puck's way while waiting, in [m].
        retreat: Distance to the puck at which the task is finished, in [m].
        longest_push: Steps after which a push is over even if nothing was felt.
        longest_adjustment: Steps after which the push starts wherever the mallet has got to: an aim may be out of its reach.
        stuck: The same, counted from when the mallet has stopped on its way.
        end_push: ds of a push at the short rim, from which the puck must come a long way, in [m]; 0: θ2.
        deeper: By how much further a push goes for each one before it that has left the puck where it was, in [m].
    """

    theta: tuple[float, ...] = field(metadata={"length": 3})
    approach: float
    wait_speed: float
    stand_off: float
    aligned: float
    longest_step: float
    side_tolerance: float
    end_tolerance: float
    bank_shot: bool
    largest_tilt: float
    near_x: float
    far_x: float
    touch: float
    touch_speed: float
    clearance: float
    retreat: float
    longest_push: float
    longest_adjustment: float = 10000.0
    stuck: float = 10000.0
    end_push: float = 0.0
    deeper: float = 0.0


def correction(beta: float, y_puck: float, aim: float = 90.0) -> float:
    """(4.13): how far β is from the aim, positive on the side that the end-effector comes from, in [°].

    Args:
        beta: β, in [°].
        y_puck: In the table frame, in [m].
        aim: β to reach below the middle, in [°]; above the middle its mirror image 360 − aim. Printed: 90.
    """
    return wrapped(beta - aim) if y_puck <= 0 else wrapped(360.0 - aim - beta)


def d_beta(theta: tuple[float, ...], phase: str, t_phase: int, correction_now: float) -> float:
    """(4.11), in [°]."""
    if phase == "acceleration":
        return correction_now
    return theta[0] * t_phase + theta[1] * correction_now


def d_s(theta: tuple[float, ...], phase: str, approach: float = 5e-3) -> float:
    """(4.12), in [m]."""
    return theta[2] if phase == "acceleration" else approach


class PreparePolicy:
    """Phases wait, adjustment, acceleration, and a retreat that the thesis does not mention."""

    def __init__(self, parameters: PrepareParameters) -> None:
        self._parameters = parameters
        self.reset()
        self.start()

    def reset(self) -> None:
        """A serve: forget the pushes before."""
        self._pushed_at: Array | None = None
        self._vain = 0

    def start(self) -> None:
        """See `Policy.start`."""
        self._enter("wait")

    def _enter(self, phase: str) -> None:
        self.phase, self._t_phase = phase, 0
        self._before, self._still = HOME, 0

    def step(self, now: Situation) -> Move:
        """See `Policy.step`."""
        p = self._parameters
        self._t_phase += 1
        tolerances = (p.side_tolerance, p.end_tolerance) if now.held <= HURRY else (0.0, 0.0)
        if self.phase != "retreat" and enough_space(now.puck.position, *tolerances):
            return Move(now.tip, finished=True)
        if self.phase == "wait":
            if now.puck.speed >= p.wait_speed or self._leaves(now.puck):
                return Move(self._stand_aside(now), finished=now.puck.speed >= 2.0 * p.wait_speed)
            self._enter("adjustment")
        moves = {"adjustment": self._adjust, "acceleration": self._push, "retreat": self._retreat}
        return moves[self.phase](now)

    def _leaves(self, puck: PuckEstimate) -> bool:
        """Whether the puck is leaving the short rim by itself, where another push would only hold it up."""
        near = HALF_LENGTH - TOLERANCE - self._parameters.end_tolerance
        rest = puck.position + puck.velocity * (PUCK.mass / PUCK.slide_damping)
        return bool(puck.position[0] < -near < rest[0] and puck.speed > _STILL)

    def _stand_aside(self, now: Situation) -> Array:
        """Where to wait: here, or further from the puck's way to its rest. Shape (2,)."""
        p, puck = self._parameters, now.puck
        if puck.speed < _STILL:
            return now.tip
        rest = puck.velocity * (PUCK.mass / PUCK.slide_damping)
        share = float(np.clip((now.tip - puck.position) @ rest / (rest @ rest), 0.0, 1.0))
        away = now.tip - (puck.position + share * rest)
        if np.hypot(*away) > CONTACT + p.clearance:
            return now.tip
        across = np.array([-rest[1], rest[0]]) / np.hypot(*rest)
        inwards = across if across @ (HOME - now.tip) > 0 else -across
        return np.asarray(now.tip + 0.5 * p.longest_step * inwards)

    def _aim(self, puck: Array) -> float:
        p = self._parameters
        return bank_aim(puck, (p.near_x, p.far_x), p.largest_tilt, p.end_tolerance) if p.bank_shot else 90.0

    def _adjust(self, now: Situation) -> Move:
        """Round the puck to the aim, then up to the stand-off."""
        p, puck = self._parameters, now.puck.position
        here = polar(puck, now.tip)
        off = correction(here.beta, puck[1], self._aim(puck))
        # θ0 t_phase grows without bound: it must not carry the end-effector past the aim, nor away from it.
        turn = float(np.copysign(min(d_beta(p.theta, "adjustment", self._t_phase, abs(off)), abs(off)), off))
        radius = max(here.radius - d_s(p.theta, "adjustment", p.approach), p.stand_off)
        target = cartesian(puck, Polar(here.beta - _side(puck) * turn, radius))
        if now.puck.speed >= 2.0 * p.wait_speed:
            return Move(now.tip, finished=True)
        self._still = self._still + 1 if np.hypot(*(now.tip - self._before)) < _STOPPED else 0
        self._before = now.tip
        arrived = abs(off) < p.aligned and here.radius < p.stand_off + 0.01
        if arrived or self._t_phase > p.longest_adjustment or self._still > p.stuck:
            self._count(puck)
            self._enter("acceleration")
        return Move(limited_step(now.tip, target, p.longest_step))

    def _count(self, puck: Array) -> None:
        """Another push begins: was the one before it in vain?"""
        vain = self._pushed_at is not None and np.hypot(*(puck - self._pushed_at)) < _LEFT
        self._vain = self._vain + 1 if vain else 0
        self._pushed_at = puck.copy()

    def _pace(self, puck: Array) -> float:
        """ds of a push, in [m]."""
        p = self._parameters
        hard = p.bank_shot and p.end_push > 0.0 and off_the_short_rim(puck, p.end_tolerance)
        return p.end_push if hard else d_s(p.theta, "acceleration")

    def _push(self, now: Situation) -> Move:
        """Straight at the puck until it is touched."""
        p, puck = self._parameters, now.puck.position
        here = polar(puck, now.tip)
        off = correction(here.beta, puck[1], self._aim(puck))
        turn = d_beta(p.theta, "acceleration", self._t_phase, off)
        pace = self._pace(puck)
        target = cartesian(puck, Polar(here.beta - _side(puck) * turn, here.radius - pace))
        touched = here.radius < CONTACT + p.touch - p.deeper * self._vain or now.puck.speed > p.touch_speed
        if touched or self._t_phase > p.longest_push:
            self._enter("retreat")
        return Move(limited_step(now.tip, target, pace))

    def _retreat(self, now: Situation) -> Move:
        """Away from the puck, faster than it follows, so that it is not caught between mallet and rim."""
        p, puck = self._parameters, now.puck.position
        here = polar(puck, now.tip)
        target = cartesian(puck, Polar(here.beta, here.radius + p.longest_step))
        return Move(limited_step(now.tip, target, p.longest_step), finished=here.radius > p.retreat)


def _side(puck: Array) -> float:
    """1 below the middle, where dβ diminishes β; −1 above it."""
    return 1.0 if puck[1] <= 0 else -1.0
