"""Where to push a puck from that lies at a border, so that it bounces off the border to where it can be hit.

A push along (n, t), n normal to the rim and t along it, leaves the rim along (−e n, (1 − κ) t).
"""

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.estimation.motion import puck_motion
from airhockey.agents.table import CONTACT, HALF_GOAL, HALF_LENGTH, HALF_WIDTH
from airhockey.agents.thesis.policy import TOLERANCE
from airhockey.envs.specs import MALLET, PUCK

Array = NDArray[np.float64]

_LARGEST_Y = HALF_WIDTH - MALLET.radius - 0.01
"""Where the mallet touches the side rim, less a centimetre, in [m]."""
_MOUTH = HALF_GOAL + PUCK.radius
"""|y| up to which a puck pushed at the short rim may meet the own goal, in [m]."""
_GOOD_Y = 0.3
"""|y| up to which a puck that comes off the short rim needs not be led inwards, in [m]."""
_SHORTEST = 0.05
"""Least way after a bounce that an aim is computed for, in [m]."""


def bank_aim(puck: Array, band: tuple[float, float], largest_tilt: float, end_tolerance: float) -> float:
    """The β from which to push, for a puck below the table's long axis; above it the mirror image 360 − β.

    A puck near the short rim is pushed at it, so that it comes back to the middle of the band; one near a side rim is
    pushed at that, so that it comes to the long axis within the band; one before the own goal is pushed aside.

    Args:
        puck: Its position, in [m]. Shape (2,).
        band: Least and largest x of good places, in [m].
        largest_tilt: Of the push from the rim's normal, in [°].
        end_tolerance: Of `enough_space`, in [m].

    Returns:
        In [°], 0 ≤ β < 360; 90 pushes straight at the side rim, 0 at the short rim.
    """
    x, y = float(puck[0]), -abs(float(puck[1]))
    if not lies_behind(puck, end_tolerance):
        sideways = float(np.clip(x, *band)) - x
        return 90.0 + _tilt(HALF_WIDTH - PUCK.radius + y, -y, sideways, largest_tilt)
    if -y < _MOUTH:
        return 90.0
    tilt = _tilt(HALF_LENGTH - PUCK.radius + x, 0.5 * sum(band) - x, max(0.0, -_GOOD_Y - y), largest_tilt)
    # To push inwards the end-effector stands nearer to the side rim than the puck, as far as there is room for it.
    room = float(np.degrees(np.arcsin(np.clip((-_LARGEST_Y - y) / CONTACT, -1.0, 1.0))))
    return max(-tilt, room) % 360.0


def lies_behind(puck: Array, end_tolerance: float) -> bool:
    """Whether a puck lies so near to the short rim that it must come forward. Shape (2,)."""
    return bool(HALF_LENGTH + puck[0] < TOLERANCE + end_tolerance)


def off_the_short_rim(puck: Array, end_tolerance: float) -> bool:
    """Whether a bank shot pushes this puck at the short rim, and not at a side rim or past the own goal. Shape (2,)."""
    return lies_behind(puck, end_tolerance) and bool(abs(puck[1]) >= _MOUTH)


def _tilt(gap: float, depth: float, sideways: float, largest: float) -> float:
    """Angle of a push from the rim's normal that takes the puck sideways on its way to the rim and back, in [°].

    Args:
        gap: From the puck to the rim, in [m].
        depth: From the rim to where the puck shall go, in [m].
        sideways: How far it shall go along the rim, in [m].
        largest: The answer's largest magnitude, in [°].
    """
    motion = puck_motion()
    grip = (1.0 - motion.slip_impulse) / motion.restitution
    tilt = np.degrees(np.arctan2(sideways, gap + grip * max(depth, _SHORTEST)))
    return float(np.clip(tilt, -largest, largest))
