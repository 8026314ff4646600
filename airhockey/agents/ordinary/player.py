"""What ordinary opponents share: eyes, an arm, and the motions of a mallet; of our players' code only the joint controller.

Everything is in the table frame: origin at its centre, x towards the other goal, y to the left, in [m].
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, hypot, sin, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.base import AgentBase
from airhockey.agents.control.joint_controller import JointController
from airhockey.agents.control.kinematics import ArmKinematics, spec_of
from airhockey.agents.control.workspace import Workspace

Array = NDArray[np.float64]

BASE_X = 1.51
GOAL_X, HALF_GOAL = 0.974, 0.125
RIM_X, RIM_Y = 0.974 - 0.03165, 0.519 - 0.03165
"""Where the puck's centre turns round, in [m]."""
TOUCH = 0.03165 + 0.04815
"""Distance of the centres at contact, in [m]."""
LEFT, RIGHT, FRONT = -0.915, 0.46, -0.06
"""Where the mallet may be: least x, largest |y|, largest x, in [m]."""
DAMPING = 0.5
"""Share of its speed that a sliding puck loses per second."""
RESTITUTION = 0.74
BENT = np.array([0.0, 0.34, 0.0, -1.10, 0.0, 1.44, 0.0])
"""A posture with the rod steeper than at the start, from which the wrist adds to the mallet's speed, in [rad]."""


@dataclass
class Hit:
    """Where the mallet is to be at the contact, how fast it moves then, and in how many seconds."""

    x: float
    y: float
    vx: float
    vy: float
    time: float


class PlainPlayer(AgentBase):
    """Sees the puck, and lets `play` move the mallet; a style is a subclass."""

    interpolation_order = 3
    x: float
    y: float
    vx: float
    vy: float

    def __init__(self, env_info: Mapping[str, Any], agent_id: int = 1, **kwargs: Any) -> None:
        super().__init__(env_info, agent_id, **kwargs)
        self.dt = float(env_info["dt"])
        self._arm = JointController(ArmKinematics(spec_of(env_info)), Workspace.of(env_info), self.dt)
        self._ids = [int(i) for i in (*env_info["puck_pos_ids"][:2], *env_info["puck_vel_ids"][:2])]
        self.posture: Array | None = None
        self.pause = 0  # steps that it still rests after a hit
        self.rng = np.random.default_rng(agent_id)
        self.reset()

    def reset(self) -> None:
        """A serve: forget the puck and what was being done."""
        self._first = True
        self.clock = 0.0  # since the puck came to our side
        self.step_count = 0
        self.hit: Hit | None = None
        self.phase = "guard"
        self._speed_kept = 0.0

    def draw_action(self, observation: Array) -> Array:
        """Look, play."""
        if self._first:
            self._arm.reset(self.get_joint_pos(observation))
        self._look(observation)
        self.step_count += 1
        self.clock = self.clock + self.dt if self.x < 0.0 else 0.0
        self.tx, self.ty = float(self._arm.tip_position()[0]) - BASE_X, float(self._arm.tip_position()[1])
        self.tvx, self.tvy = (float(v) for v in self._arm.tip_velocity())
        return self.play()

    def play(self) -> Array:
        """One step of this style. Shape (2, n)."""
        raise NotImplementedError

    # --- eyes -------------------------------------------------------------------------------------------------------

    def _look(self, observation: Array) -> None:
        """An alpha-beta filter; what does not fit (a bounce, a hit) is believed as it is seen."""
        x, y, vx, vy = (float(observation[i]) for i in self._ids)
        x -= BASE_X
        if not self._first:
            rx, ry = x - (self.x + self.dt * self.vx), y - (self.y + self.dt * self.vy)
            if hypot(vx - self.vx, vy - self.vy) < 0.25:
                x, y = x - 0.5 * rx, y - 0.5 * ry
                vx, vy = 0.7 * self.vx + 0.3 * vx, 0.7 * self.vy + 0.3 * vy
        self.x, self.y, self.vx, self.vy = x, y, vx, vy
        self.speed = hypot(vx, vy)
        self._first = False

    def ahead(self, time: float, bounces: bool = True) -> tuple[float, float]:
        """Where the puck will be, folded back at the side rims or running straight on."""
        reach = (1.0 - np.exp(-DAMPING * time)) / DAMPING
        x, y = self.x + reach * self.vx, self.y + reach * self.vy
        if bounces:
            while abs(y) > RIM_Y:
                y = (1.0 if y > 0 else -1.0) * (RIM_Y - RESTITUTION * (abs(y) - RIM_Y))
        if x < -RIM_X and abs(y) > HALF_GOAL:
            x = -RIM_X + RESTITUTION * (-RIM_X - x)
        return x, y

    def time_to(self, line: float) -> float | None:
        """Until the puck, coming, is at x = line, in [s]."""
        if self.vx > -0.05 or self.x < line:
            return None
        share = 1.0 - DAMPING * (line - self.x) / self.vx
        return -float(np.log(share)) / DAMPING if share > 0.0 else None

    # --- the mallet -------------------------------------------------------------------------------------------------

    def command(self, x: float, y: float, vx: float, vy: float) -> Array:
        """The mallet's place and velocity at the end of this step. Shape (2, n)."""
        x, y = min(max(x, LEFT), FRONT), min(max(y, -RIGHT), RIGHT)
        anchor = None
        if self.posture is not None:
            q = self._arm.state.position
            anchor = q + 4.0 * (self.posture - q)
        return self._arm.step(np.array([x + BASE_X, y]), np.array([vx, vy]), anchor)

    def toward(self, vx: float, vy: float, acceleration: float) -> Array:
        """One step towards a velocity of the mallet."""
        cx, cy = vx - self.tvx, vy - self.tvy
        share = min(1.0, acceleration * self.dt / max(hypot(cx, cy), 1e-9))
        vx, vy = self.tvx + share * cx, self.tvy + share * cy
        return self.command(
            self.tx + 0.5 * self.dt * (self.tvx + vx), self.ty + 0.5 * self.dt * (self.tvy + vy), vx, vy
        )

    def go(self, x: float, y: float, speed: float, acceleration: float, keep_off: bool = False) -> Array:
        """One step towards a place, to rest there; round the puck where it should be kept off."""
        if keep_off:
            x, y = self._round(x, y)
        x, y = min(max(x, LEFT), FRONT), min(max(y, -RIGHT), RIGHT)
        wx, wy = x - self.tx, y - self.ty
        distance = max(hypot(wx, wy), 1e-9)
        pace = min(speed, sqrt(acceleration * distance), 10.0 * distance)
        return self.toward(wx / distance * pace, wy / distance * pace, acceleration)

    def _round(self, x: float, y: float) -> tuple[float, float]:
        """A place beside the puck where the straight way would touch it."""
        px, py = self.ahead(0.1)
        wx, wy = x - self.tx, y - self.ty
        length = wx * wx + wy * wy
        share = min(max(((px - self.tx) * wx + (py - self.ty) * wy) / max(length, 1e-9), 0.0), 1.0)
        near = hypot(self.tx + share * wx - px, self.ty + share * wy - py)
        if near > TOUCH + 0.012 or share in (0.0, 1.0):
            return x, y
        side = 1.0 if self.ty > py or (self.ty == py and py < 0) else -1.0
        if abs(py + side * (TOUCH + 0.03)) > RIGHT:
            side = -side
        return px + 0.3 * (self.tx - px), py + side * (TOUCH + 0.035)

    # --- hits -------------------------------------------------------------------------------------------------------

    def plan_hit(self, angle_of: Any, speed: float, times: Array, hardest: float = 14.0) -> Hit | None:
        """The first contact that a cubic brings the mallet to with that speed along the direction `angle_of(x, y)` [rad]."""
        for time in times:
            px, py = self.ahead(float(time))
            if not -0.84 < px < -0.15 or abs(py) > RIM_Y - 0.02:
                continue
            angle = angle_of(px, py)
            nx, ny = cos(angle), sin(angle)
            hit = Hit(px - TOUCH * nx, py - TOUCH * ny, speed * nx, speed * ny, float(time))
            if self._possible(hit, hardest):
                return hit
        return None

    def _possible(self, hit: Hit, hardest: float) -> bool:
        t = hit.time
        for start, velocity, end, leaving, low, high in (
            (self.tx, self.tvx, hit.x, hit.vx, LEFT, FRONT - 0.1),
            (self.ty, self.tvy, hit.y, hit.vy, -RIGHT, RIGHT),
        ):
            way = (end - start) / t
            first = (6.0 * way - 4.0 * velocity - 2.0 * leaving) / t
            last = (-6.0 * way + 2.0 * velocity + 4.0 * leaving) / t
            if max(abs(first), abs(last)) > hardest or not low <= end <= high:
                return False
            for s in (0.25, 0.5, 0.75):
                at = start + s * t * (velocity + s * t * (first / 2.0 + s * (last - first) / 6.0))
                if not low - 0.003 <= at <= high:
                    return False
        return True

    def follow(self, hit: Hit, through: float = 0.04) -> tuple[Array, bool]:
        """One step along the cubic to a hit, then straight on; and whether it is over."""
        left = hit.time - self.dt
        if hit.time <= self.dt:
            hit.time = left
            return self.command(hit.x - left * hit.vx, hit.y - left * hit.vy, hit.vx, hit.vy), left < -through
        t, s = hit.time, self.dt / hit.time
        places = []
        for start, velocity, end, leaving in ((self.tx, self.tvx, hit.x, hit.vx), (self.ty, self.tvy, hit.y, hit.vy)):
            way = end - start
            c2, c3 = 3.0 * way - (2.0 * velocity + leaving) * t, (velocity + leaving) * t - 2.0 * way
            place = start + s * (velocity * t + s * (c2 + s * c3))
            places.append((place, (velocity * t + s * (2.0 * c2 + 3.0 * s * c3)) / t))
        hit.time = left
        return self.command(places[0][0], places[1][0], places[0][1], places[1][1]), False

    def hitting(
        self, velocity: tuple[float, float], acceleration: float, pause: int, through: float = 0.04
    ) -> Array | None:
        """One step of the hit under way, or of the pause after it; None where there is neither.

        Args:
            velocity, acceleration: Which the mallet takes up in the pause, in [m]/[s], and how fast, in [m]/[s²].
            pause: Its length, in steps.
            through: As for `follow`.

        Returns:
            Shape (2, n).
        """
        if self.hit is not None:
            action, over = self.follow(self.hit, through)
            if over:
                self.hit, self.pause = None, pause
            return action
        if self.pause > 0:
            self.pause -= 1
            return self.toward(*velocity, acceleration)
        return None


def straight(x: float, y: float, aim: float) -> float:
    """The direction from a place to y = aim on the goal line, in [rad]."""
    return float(np.arctan2(aim - y, GOAL_X - x))


def bank(x: float, y: float, aim: float, side: float) -> float:
    """The same by one bounce off the rim at side · y > 0: the way back is 1/e as long."""
    return float(np.arctan2(side * RIM_Y + side * (RIM_Y - side * aim) / RESTITUTION - y, GOAL_X - x))
