"""When a mallet hit the puck, from where both were at the ends of control steps.

Contacts are not recorded, but what they leave is: the puck's velocity changes, along the line from mallet to puck (a mallet
has no friction, so nothing else can happen), while the two are no further apart than they can have moved since they touched.
A bounce off a rim changes the velocity too, but towards the mallet or far from it.
"""

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.specs import CONTROL_PERIOD, MALLET, PUCK

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

LEAST_IMPULSE = 0.1
"""Smallest change of the puck's velocity in a step that counts, in [m/s]: friction alone takes 1 % of the speed."""
_ALONG = 0.8  # least cosine of the angle between the change and the line of centres
_SLACK = 0.005  # [m]
_PAUSE = 3  # steps without contact that end a hit: pushing is one hit


def contacts(before: Array, after: Array, mallet_before: Array, mallet_after: Array) -> Mask:
    """The steps in which a mallet touched the puck.

    Args:
        before, after: The puck's x, y, yaw, ẋ, ẏ, … at the step's beginning and end, in [m] and [m/s]. Shape (steps, ≥ 5).
        mallet_before, mallet_after: The mallet's x, y, in [m]. Shape (steps, 2).

    Returns:
        Shape (steps,).
    """
    impulse = after[:, 3:5] - before[:, 3:5]
    size = np.linalg.norm(impulse, axis=1)
    apart_before, apart_after = before[:, :2] - mallet_before, after[:, :2] - mallet_after
    distance_before, distance_after = (np.linalg.norm(apart, axis=1) for apart in (apart_before, apart_after))
    nearer = np.where((distance_after < distance_before)[:, None], apart_after, apart_before)
    nearest = np.minimum(distance_before, distance_after)
    mallet_velocity = (mallet_after - mallet_before) / CONTROL_PERIOD
    fastest = np.maximum(*(np.linalg.norm(puck[:, 3:5] - mallet_velocity, axis=1) for puck in (before, after)))
    # Who touches within a step is at one of its ends no further apart than half a step's way.
    reached = nearest - PUCK.radius - MALLET.radius < fastest * CONTROL_PERIOD / 2 + _SLACK
    along = np.einsum("ij,ij->i", impulse, nearer) > _ALONG * size * np.linalg.norm(nearer, axis=1)
    return np.asarray((size > LEAST_IMPULSE) & reached & along)


def hits(touching: Mask, first_of_part: Mask) -> NDArray[np.int64]:
    """The first and last steps of the hits: contacts with at most two steps between them are one hit.

    Args:
        touching: Shape (steps,).
        first_of_part: Where an episode or a serve begins, which no hit lasts beyond. Shape (steps,).

    Returns:
        Indices of steps. Shape (hits, 2).
    """
    steps = np.flatnonzero(touching)
    part = np.cumsum(first_of_part)[steps]
    between = (np.diff(steps) >= _PAUSE) | (np.diff(part) > 0)
    begins, ends = np.ones(steps.size, dtype=bool), np.ones(steps.size, dtype=bool)
    begins[1:] = ends[:-1] = between
    return np.stack([steps[begins], steps[ends]], axis=1)
