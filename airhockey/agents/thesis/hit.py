"""The hit task: drive the puck into the opponent's goal (thesis 4.2.1).

β is the angle between the lines from the puck to the goal and from the puck to the end-effector; 180° is right behind
it. With t_phase in steps, (4.4) and (4.5):

    dβ = (θ0 + θ1 t_phase dt) correction  (adjustment),  correction / 2  (acceleration),  (θ0 + θ1 dt) correction
    (slow-down) ds = θ2  (adjustment),  (ds_{t−1} + θ3 t_phase dt) / (radius + r_mallet)  (acceleration),  constant
    (slow-down) correction = 180 − β  (y_puck ≤ table_width / 2),  β − 180  (y_puck > table_width / 2)

Heights y of the printed case distinction are counted from the table's edge: its halves are y ≤ 0 and y > 0 here. dβ
counts towards 180°: in the lower half β grows by it, in the upper half it shrinks.
"""

from dataclasses import dataclass, field
from math import asin, cos, degrees, hypot, inf, radians, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.estimation.side_clock import HURRY
from airhockey.agents.skill import Situation
from airhockey.agents.table import CONTACT, HALF_LENGTH, HALF_WIDTH, OPPONENT_GOAL
from airhockey.agents.thesis.opponent import OpponentWatch
from airhockey.agents.thesis.polar import (
    Polar,
    cartesian,
    direction_angle,
    distance,
    limited_step,
    polar,
    stoppable_step,
)
from airhockey.agents.thesis.policy import Move, enough_space
from airhockey.envs.specs import MALLET, PUCK

Array = NDArray[np.float64]

_DECAY = PUCK.slide_damping / PUCK.mass
"""Share of its velocity that a sliding puck loses per second, in [1/s]."""
_PASSING = np.array([-1.5, -0.75, 0.0, 0.75]) * CONTACT
"""Where a puck that goes by is looked at, from the opponent's mallet along its way, in [m]."""
_EDGE = 0.012
"""Room that is left between mallet and rim, in [m]."""


@dataclass(frozen=True)
class HitParameters:
    """What can be tuned about the hit.

    Attributes:
        theta: θ0, θ1 [1/s], θ2 [m], θ3 [m]/[s].
        wait_speed: The puck is waited for until it is slower, in [m]/[s].
        follow: Go behind the puck while waiting for it; the thesis stands still.
        stand_off: Least distance to the puck while adjusting, in [m].
        run_up: Largest distance at which the acceleration may start, in [m].
        aligned: Largest |correction| at which it starts, in [°].
        longest_step: Of the end-effector in the adjustment, in [m].
        fastest_step: Of the end-effector in the acceleration, in [m].
        acceleration: With which the end-effector can stop, in [m]/[s²].
        side_tolerance, end_tolerance: Of `enough_space`, in [m].
        strike_time: From the start of the acceleration to the contact, in [s].
        leaving_speed: Of the puck: at the table's centre, per x and per |y| of where it is hit, in [m]/[s], [1/s],
            [1/s].
        across: How much of the puck's own motion across the line is corrected for; less than 1, since a contact takes
            time.
        gap: Least distance from the opponent's mallet at which the puck shall pass it, in [m]; 0 does not look.
        patience: Steps that a gap is waited for beside an opponent that repeats itself.
        hesitation: Steps that a gap is waited for beside another one.
        slow_down: Share of its velocity that the end-effector keeps in each step of the slow-down.
        keep_ds: The slow-down goes on with the acceleration's ds, as printed (4.5), instead of braking.
        longest_slow_down: Steps after which such a slow-down is over.
        struck_speed: Of the puck, which shows that it was hit, in [m]/[s].
        longest_strike: Steps after which an acceleration is given up.
        rest_speed: Speed at which the slow-down is over, in [m]/[s].
    """

    theta: tuple[float, ...] = field(metadata={"length": 4})
    wait_speed: float
    follow: bool
    stand_off: float
    run_up: float
    aligned: float
    longest_step: float
    fastest_step: float
    acceleration: float
    side_tolerance: float
    end_tolerance: float
    strike_time: float
    leaving_speed: tuple[float, ...] = field(metadata={"length": 3})
    across: float
    gap: float
    patience: float
    hesitation: float
    slow_down: float
    struck_speed: float
    longest_strike: float
    rest_speed: float
    keep_ds: bool = False
    longest_slow_down: float = 50.0


def correction(beta: float, y_puck: float) -> float:
    """Way of β to 180°, positive on the side that the end-effector comes from, in [°]."""
    return 180.0 - beta if y_puck <= 0 else beta - 180.0


def d_beta(theta: tuple[float, ...], phase: str, t_phase: int, dt: float, correction_now: float) -> float:
    """(4.4), in [°]."""
    if phase == "acceleration":
        return correction_now / 2.0
    time = t_phase * dt if phase == "adjustment" else dt
    return (theta[0] + theta[1] * time) * correction_now


def d_s(theta: tuple[float, ...], phase: str, t_phase: int, dt: float, before: float, radius: float) -> float:
    """(4.5), in [m].

    Args:
        theta: θ.
        phase: "adjustment", "acceleration" or "slow-down".
        t_phase: Steps in this phase.
        dt: Length of a step, in [s].
        before: ds of the step before, in [m].
        radius: Distance of end-effector and puck, in [m].
    """
    if phase == "acceleration":
        return (before + theta[3] * t_phase * dt) / (radius + MALLET.radius)
    return theta[2] if phase == "adjustment" else before


class HitPolicy:
    """Phases wait, adjustment, acceleration, slow-down."""

    def __init__(self, parameters: HitParameters, opponent: OpponentWatch) -> None:
        self._parameters, self._opponent = parameters, opponent
        self.start()

    def start(self) -> None:
        """See `Policy.start`."""
        self._enter("wait")

    def _enter(self, phase: str) -> None:
        self.phase, self._t_phase = phase, 0
        self._ds = self._parameters.theta[2]

    def step(self, now: Situation) -> Move:
        """See `Policy.step`."""
        self._t_phase += 1
        if self.phase == "slow-down":
            return self._slow_down(now)
        if self.phase == "acceleration":
            return self._accelerate(now)
        p, puck = self._parameters, now.puck
        tolerances = (p.side_tolerance, p.end_tolerance) if now.held <= HURRY else (0.0, 0.0)
        if not enough_space(puck.position, *tolerances) or puck.position[0] > 0.0:
            return Move(now.tip, finished=True)
        too_fast = puck.speed > 2.0 * p.wait_speed
        if self.phase == "wait":
            if puck.speed < p.wait_speed:
                self._enter("adjustment")
            elif not p.follow:
                return Move(now.tip, finished=too_fast)
        move = self._adjust(now)
        return Move(move.target, finished=too_fast)

    def _aim(self, now: Situation) -> tuple[Array, float]:
        """Where the puck will be when it is hit, (2,), and γ, corrected for the puck's own motion across the line."""
        p = self._parameters
        reach = distance(now.puck.position, now.tip) - CONTACT
        share = min(max(reach / (p.stand_off - CONTACT), 0.0), 1.0)
        remaining = p.strike_time * (1.0 - sqrt(1.0 - share))  # of a motion at constant acceleration
        puck = now.puck.position + remaining * now.puck.velocity
        gamma = radians(direction_angle(puck, OPPONENT_GOAL))
        forward, sideways = now.puck.velocity.tolist()
        across = sideways * cos(gamma) - forward * sin(gamma)
        return puck, degrees(gamma - asin(min(max(p.across * across / self._speed(puck), -0.5), 0.5)))

    def _speed(self, puck: Array) -> float:
        """Speed of the puck after a hit there, in [m]/[s]."""
        base, by_x, by_y = self._parameters.leaving_speed
        return max(base + by_x * float(puck[0]) + by_y * abs(float(puck[1])), 0.5)

    def _adjust(self, now: Situation) -> Move:
        """Behind the puck, and there until the opponent leaves a gap."""
        p = self._parameters
        puck, gamma = self._aim(now)
        here, side = polar(puck, now.tip, gamma), _side(puck)
        off = correction(here.beta, puck[1])
        turn = d_beta(p.theta, "adjustment", self._t_phase, now.dt, off)
        turn = min(max(turn, -abs(off)), abs(off))
        self._ds = d_s(p.theta, "adjustment", self._t_phase, now.dt, self._ds, here.radius)
        stand_off = min(p.stand_off, room_behind(puck, gamma))
        radius = max(here.radius - self._ds, stand_off)
        target = cartesian(puck, Polar(here.beta + side * turn, radius), gamma)
        run_up = stand_off + p.run_up - p.stand_off
        ready = self.phase == "adjustment" and abs(off) < p.aligned and here.radius < run_up
        if ready and (now.held > HURRY or self._out_of_patience() or self._gap(now)):
            self._enter("acceleration")
        end = cartesian(puck, Polar(180.0, stand_off), gamma)
        longest = min(p.longest_step, stoppable_step(now.tip, end, p.acceleration, now.dt))
        return Move(limited_step(now.tip, target, longest))

    def _out_of_patience(self) -> bool:
        p = self._parameters
        return self._t_phase > (p.patience if self._opponent.repeats else p.hesitation)

    def _gap(self, now: Situation) -> bool:
        """Whether the opponent's mallet will be out of the way while the puck goes by."""
        p, puck = self._parameters, now.puck.position
        mallet = self._opponent.predict(0.0)
        if p.gap <= 0.0 or mallet is None:
            return True
        if not self._opponent.ready:
            return False
        way = (OPPONENT_GOAL - puck) / distance(OPPONENT_GOAL, puck)
        across, speed = np.array([-way[1], way[0]]), self._speed(puck)
        passing = float(way @ (mallet - puck)) + _PASSING
        slowed = np.minimum(np.maximum(_DECAY * passing / speed, 0.0), 0.95)
        times = p.strike_time - np.log(1.0 - slowed) / _DECAY
        return all(abs(across @ (mallet - puck)) > p.gap for mallet in self._opponent.along(times))

    def _accelerate(self, now: Situation) -> Move:
        """Through the puck, along the line to the goal."""
        p = self._parameters
        puck, gamma = self._aim(now)
        here = polar(puck, now.tip, gamma)
        if abs(here.beta - 180.0) > 60.0 or now.puck.velocity[0] > p.struck_speed or self._t_phase > p.longest_strike:
            self._enter("slow-down")
            return self._slow_down(now)
        turn = d_beta(p.theta, "acceleration", self._t_phase, now.dt, correction(here.beta, puck[1]))
        self._ds = d_s(p.theta, "acceleration", self._t_phase, now.dt, self._ds, here.radius)
        self._ds = min(self._ds, p.fastest_step)
        target = cartesian(puck, Polar(here.beta + _side(puck) * turn, here.radius - self._ds), gamma)
        return Move(target)

    def _slow_down(self, now: Situation) -> Move:
        """Brake on the way, on the curve that dβ gives."""
        p = self._parameters
        puck, gamma = self._aim(now)
        off = correction(polar(puck, now.tip, gamma).beta, puck[1])
        turn = _side(puck) * d_beta(p.theta, "slow-down", self._t_phase, now.dt, off)
        if p.keep_ds:
            here = polar(puck, now.tip, gamma)
            ahead = cartesian(puck, Polar(here.beta + turn, here.radius - self._ds), gamma)
            return Move(ahead, self._t_phase > p.longest_slow_down or puck[0] > 0.0)
        turn = radians(turn)
        rotation = np.array([[cos(turn), -sin(turn)], [sin(turn), cos(turn)]])
        velocity = p.slow_down * rotation @ now.tip_velocity
        target = now.tip + 0.5 * now.dt * (velocity + now.tip_velocity)
        return Move(target, hypot(*now.tip_velocity) < p.rest_speed, velocity)


def room_behind(puck: Array, gamma: float) -> float:
    """Largest distance at which the mallet can stand behind the puck on the line to the goal, in [m]."""
    turned, (x, y) = radians(gamma), puck.tolist()
    reach = inf
    for along, half, place in ((cos(turned), HALF_LENGTH, x), (sin(turned), HALF_WIDTH, y)):
        room = half - MALLET.radius - _EDGE + (place if along > 0.0 else -place)
        reach = min(reach, room / max(abs(along), 1e-9))
    return max(reach, CONTACT)


def _side(puck: Array) -> float:
    """1 in the lower half, where dβ enlarges β; −1 in the upper half."""
    return 1.0 if puck[1] <= 0 else -1.0
