"""The triangle reward of the hit (thesis 4.2.1, equations 4.6 to 4.8)."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.rewards.formulas import angle_outside, approach, inside_triangle, strike
from airhockey.envs.rewards.reward import Reward
from airhockey.envs.rewards.situation import Situation, situation
from airhockey.envs.specs import CONTROL_PERIOD, MALLET, PUCK

Array = NDArray[np.float64]

_JUMP = 0.05
"""Change of the puck's velocity within a step that friction does not explain, in [m]/[s]."""
_NEAR = 0.01
"""Gap between puck and mallet beyond what they travel in a step, at which they may have touched, in [m]."""


class HitReward(Reward):
    """Every step: the way to the puck, then the hit, then whether the puck stays on its way into the goal.

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
            return self._after_the_hit(state[:2], next_state[:2], next_state[3:5])
        before, after = situation(env, state), situation(env, next_state)
        if met(before, after):
            self._hit = True
            max_speed = float(env.env_info["rl_info"].observation_space.high[3])  # of the puck, the fastest thing here
            return {"hit": strike(after.mallet_velocity, max_speed, self._hit_bonus, self._weight)}
        return {"approach": approach(after.mallet, after.puck)}

    def _after_the_hit(self, puck_before: Array, puck: Array, puck_velocity: Array) -> dict[str, float]:
        """(4.7)."""
        if inside_triangle(puck_before, puck):
            return {"inside": self._weight + math.hypot(*puck_velocity)}
        return {"outside": -angle_outside(puck_before, puck_velocity)}


def met(before: Situation, after: Situation) -> bool:
    """Whether mallet and puck met within a step: the puck's velocity jumped while the mallet was at hand."""
    if math.hypot(*(after.puck_velocity - before.puck_velocity)) < _JUMP:
        return False
    gap = min(math.hypot(*(at.puck - at.mallet)) for at in (before, after)) - PUCK.radius - MALLET.radius
    travel = CONTROL_PERIOD * max(math.hypot(*(at.puck_velocity - at.mallet_velocity)) for at in (before, after))
    return gap < _NEAR + travel
