r"""Hit: score a goal with a puck that lies on the own half, or rolls slowly there.

Environments `3dof-hit` and `7dof-hit`; in the latter robot 2 moves its mallet along a figure of eight before its goal. In the
edition of 2025: `hit`, which is like `7dof-hit`, and `hit_single`, without robot 2.
World coordinates: origin in the table's centre, x towards the opponent's goal. The edition's file has the numbers.

| start | quantity | range | unit |
|---|---|---|---|
| 3dof-hit | puck x, y | -0.7 … -0.2, ±0.39105, at rest | m |
| 7dof-hit, hit, hit_single | puck x, y | the same | m |
| | speed; direction, from -x | 0 … 0.5; ±(π/2 + 0.1) | m/s; rad |
| | yaw rate | ±2 | rad/s |
| hit, hit_single | motion, drawn again until | \|y + ẏ · 1 s\| < 0.43 | m |
| both | joints | the robot's start, at rest | rad |

| ends | when |
|---|---|
| off the table | \|x\| > 0.974 or \|y\| > 0.519, goals included, or ‖(ẋ, ẏ, yaw rate)‖ > 100 |
| task over | x > 0 and ẋ < 0: the puck comes back |
| horizon | 500 control steps of 0.02 s |

Success: x > 0.974 and \|y\| < 0.125, the opponent's goal, at the last step.

| reward | when | value |
|---|---|---|
| goal | the puck is in the opponent's goal | 1 / (1 - γ) |
| hit | mallet and puck meet for the first time | 100 + 10 (1 - (2α/π)²) ‖v_ee‖ / max_vel |
| inside | after the hit, in the triangle of goal and previous puck | 10 + ‖v_puck‖ |
| outside | after the hit, elsewhere | -diff_angle |
| approach | before the hit | -‖ee - puck‖ / (0.5 table_diag) |
| constraints | every step | -α (4.2) |

| observation | quantity | range | unit |
|---|---|---|---|
| 0, 1, 2 | puck x, y, yaw in the robot frame | 0 … 3.02, ±1, ±π | m, m, rad |
| 3, 4, 5 | puck velocity | ±20, ±20, ±100 | m/s, m/s, rad/s |
| 6 … 5+n | joint positions | the joints' range | rad |
| 6+n … 5+2n | joint velocities, filtered | the joints' limits | rad/s |
| 6+2n … 8+2n | opponent's rod tip x, y, z (7dof-hit, hit) | 1.5 … 4.5, ±1.5, ±1.5 | m |

| action, by order | rows | range | unit |
|---|---|---|---|
| 1, 2 | joint positions, shape (n,) | the joints' range | rad |
| 3, 4, -1 | positions, velocities, shape (2, n) | and the velocity limits | rad, rad/s |
| 5 | positions, velocities, accelerations, shape (3, n) | and the acceleration limits | …, rad/s² |
| None | 20 set-points of all three, shape (20, 3, n) | the same | rad, rad/s, rad/s² |

n is 3 or 7.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.specs import CONTROL_PERIOD, MALLET, PUCK, TABLE, X_VELOCITY, Y_VELOCITY, X, Y
from airhockey.envs.tasks.positions import PuckAndMallet, puck_and_mallet
from airhockey.envs.tasks.reward import Reward
from airhockey.envs.tasks.task import Task
from airhockey.envs.tasks.verdicts import Rules, compiled, off_table, verdict_of

Array = NDArray[np.float64]

TABLE_DIAGONAL = math.hypot(TABLE.length, TABLE.width)
"""In [m]."""
GOAL_POSTS = np.array([[TABLE.length / 2, TABLE.goal_width / 2], [TABLE.length / 2, -TABLE.goal_width / 2]])
"""Ends of the opponent's goal, in world coordinates, in [m]. Shape (2, 2)."""
_JUMP = 0.05
"""Change of the puck's velocity within a step that friction does not explain, in [m]/[s]."""
_NEAR = 0.01
"""Gap between puck and mallet beyond what they travel in a step, at which they may have touched, in [m]."""


@compiled
def over(rules: Rules, puck: Array) -> bool:
    """The puck comes back from the other half: nothing more can happen."""
    return bool(puck[X] > 0.0 and puck[X_VELOCITY] < 0.0)


@compiled
def succeeded(rules: Rules, puck: Array) -> bool:
    """The puck is in the opponent's goal."""
    return bool(puck[X] > rules.half_length and abs(puck[Y]) < rules.goal_half_width)


@compiled
def judge(referee: Any, left: Array) -> int:
    """See `Task.judge`."""
    rules = referee[0]
    return verdict_of(off_table(rules, left), over(rules, left), succeeded(rules, left))


class HitReward(Reward):
    """The triangle reward (thesis 4.2.1, (4.6) to (4.8)): the way to the puck, the hit, then whether the puck stays on its way.

    | term | when | value |
    |---|---|---|
    | goal | the puck is in the opponent's goal | 1 / (1 − γ) |
    | hit | mallet and puck meet for the first time | 100 + 10 (1 − (2α/π)²) ‖v_ee‖ / max_vel |
    | inside | after the hit, in the triangle of goal and previous puck | 10 + ‖v_puck‖ |
    | outside | after the hit, elsewhere | −diff_angle |
    | approach | before the hit | −‖ee − puck‖ / (0.5 table_diag) |
    | constraints | every step | −α (4.2) |
    """

    def __init__(
        self,
        discount: float | None = None,
        hit_bonus: float = 100.0,
        weight: float = 10.0,
        constraint_weight: float = 1.0,
    ) -> None:
        """Make the reward.

        Args:
            discount: γ; by default the environment's.
            hit_bonus: A of (4.6).
            weight: B of (4.6) and (4.7).
            constraint_weight: α of (4.8).
        """
        super().__init__(constraint_weight)
        self._discount, self._hit_bonus, self._weight = discount, hit_bonus, weight
        self.start()

    def start(self) -> None:
        """See `Reward.start`."""
        self._hit = False

    def task_terms(self, env: Any, state: Array, next_state: Array, absorbing: bool) -> dict[str, float]:
        """See `Reward.task_terms`."""
        if env.succeeded:
            discount = env.env_info["rl_info"].gamma if self._discount is None else self._discount
            return {"goal": 1.0 / (1.0 - discount)}
        if self._hit:
            return self._after_the_hit(state[X : Y + 1], next_state[X : Y + 1], next_state[X_VELOCITY : Y_VELOCITY + 1])
        before, after = puck_and_mallet(env, state), puck_and_mallet(env, next_state)
        if met(before, after):
            self._hit = True
            max_speed = float(
                env.env_info["rl_info"].observation_space.high[X_VELOCITY]
            )  # of the puck, the fastest thing here
            return {"hit": strike(after.mallet_velocity, max_speed, self._hit_bonus, self._weight)}
        return {"approach": approach(after.mallet, after.puck)}

    def _after_the_hit(self, puck_before: Array, puck: Array, puck_velocity: Array) -> dict[str, float]:
        """(4.7)."""
        if inside_triangle(puck_before, puck):
            return {"inside": self._weight + math.hypot(*puck_velocity)}
        return {"outside": -angle_outside(puck_before, puck_velocity)}


def met(before: PuckAndMallet, after: PuckAndMallet) -> bool:
    """Whether mallet and puck met within a step: the puck's velocity jumped while the mallet was at hand."""
    if math.hypot(*(after.puck_velocity - before.puck_velocity)) < _JUMP:
        return False
    gap = min(math.hypot(*(at.puck - at.mallet)) for at in (before, after)) - PUCK.radius - MALLET.radius
    travel = CONTROL_PERIOD * max(math.hypot(*(at.puck_velocity - at.mallet_velocity)) for at in (before, after))
    return gap < _NEAR + travel


def approach(mallet: Array, puck: Array) -> float:
    """(4.6), no hit: −‖ee − puck‖ / (0.5 table_diag). Positions in [m], of shape (2,)."""
    return -math.hypot(*(mallet - puck)) / (0.5 * TABLE_DIAGONAL)


def strike(mallet_velocity: Array, max_speed: float, bonus: float = 100.0, weight: float = 10.0) -> float:
    """(4.6), hit: A + B (1 − (2α/π)²) ‖v_ee‖ / max_vel, with α the direction of v_ee.

    Args:
        mallet_velocity: v_ee, in [m]/[s]. Shape (2,).
        max_speed: Largest speed that can be observed, in [m]/[s].
        bonus: A.
        weight: B.
    """
    alpha = math.atan2(mallet_velocity[1], mallet_velocity[0])
    return bonus + weight * (1.0 - (2.0 * alpha / math.pi) ** 2) * math.hypot(*mallet_velocity) / max_speed


def inside_triangle(puck_before: Array, puck: Array) -> bool:
    """Whether the puck is in the triangle of the opponent's goal and the puck's previous position (figure 4.3)."""
    corners = np.vstack((GOAL_POSTS, puck_before))
    sides = np.roll(corners, -1, axis=0) - corners
    to_puck = puck - corners
    turns = sides[:, 0] * to_puck[:, 1] - sides[:, 1] * to_puck[:, 0]
    return bool((turns <= 1e-12).all() or (turns >= -1e-12).all())  # on the border is inside


def angle_outside(puck_before: Array, puck_velocity: Array) -> float:
    """diff_angle of (4.7): angle between the puck's velocity and the nearer border of the triangle, in [rad], 0 … π.

    Args:
        puck_before: Apex of the triangle, in [m]. Shape (2,).
        puck_velocity: In [m]/[s]. Shape (2,).
    """
    direction = math.atan2(puck_velocity[1], puck_velocity[0])
    borders = [math.atan2(post[1] - puck_before[1], post[0] - puck_before[0]) for post in GOAL_POSTS]
    return min(abs(math.remainder(direction - border, 2.0 * math.pi)) for border in borders)


TASK = Task(judge, HitReward)
