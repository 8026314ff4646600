"""The formulas of the thesis's rewards, each a function of plain numbers (4.1.3, 4.2.1)."""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.specs import TABLE

Array = NDArray[np.float64]

TABLE_DIAGONAL = math.hypot(TABLE.length, TABLE.width)
"""In [m]."""
GOAL_POSTS = np.array([[TABLE.length / 2, TABLE.goal_width / 2], [TABLE.length / 2, -TABLE.goal_width / 2]])
"""Ends of the opponent's goal, in world coordinates, in [m]. Shape (2, 2)."""


def normalized_violated_constraints(values: Mapping[str, Array], penalty_points: Mapping[str, float]) -> float:
    """(4.2): Σᵢ φᵢ (1/N Σⱼ σⱼ) / Σᵢ φᵢ.

    i runs over the constraints of the robot; σⱼ are the positive slacks (4.3) of constraint i and N is their number, so
    that a constraint counts by how far it is violated and not by how many joints it has. A constraint that holds adds
    nothing to the numerator; its φᵢ stays in the denominator, or a single violated one would lose its weight.

    Args:
        values: Constraint name -> current value less limit, violated where positive. Shapes (c,).
        penalty_points: Constraint name -> φ.
    """
    weighted = sum(penalty_points[name] * mean_violation(slack) for name, slack in values.items())
    return weighted / sum(penalty_points[name] for name in values)


def mean_violation(slack: Array) -> float:
    """Mean of the positive entries; 0 where there is none."""
    violated = slack[slack > 0.0]
    return float(violated.mean()) if violated.size else 0.0


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
