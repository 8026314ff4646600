"""What a mallet does to a puck: the restitution of the soft contact, and how to move so that the puck leaves as wanted."""

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.agents.estimation.motion import slide
from airhockey.agents.table import CONTACT
from airhockey.envs.specs import PUCK

Array = NDArray[np.float64]

RESTITUTION = 0.438
"""Share of the relative normal speed that a contact leaves, at any speed: MuJoCo's contact with damping ratio 0.3
and impedance 0.95; the contact lasts about 20 ms. The iiwa's mallet gives way a little above 2 m/s."""
PUCK_RADIUS = PUCK.radius


@compiled
def redirecting(state: Array, leaving: Array, grip: bool) -> tuple[Array, Array]:
    """Where the mallet's centre is and how it moves when it touches a puck that shall leave with a given velocity.

    The impulse acts along the line of centres, so the normal n (mallet to puck) is the direction of the change of velocity. With
    the puck's normal velocity v and the mallet's u (both along n) before, v' after:

        v' − u = e (u − v),   so   u = v + (v' − v)/(1 + e).

    Where the mallet grips the puck, it moves along with the puck's surface: no slip, no tangential impulse.

    Args:
        state: Of the puck at the contact. Shape (5,).
        leaving: Velocity that it shall leave with, in [m]/[s]. Shape (2,).
        grip: Whether the mallet has friction.

    Returns:
        In [m] and [m]/[s]. Shapes (2,), (2,).
    """
    change = leaving - state[2:4]
    size = np.hypot(change[0], change[1])
    normal = change / size if size > 1e-6 else np.array([1.0, 0.0])
    before = state[2] * normal[0] + state[3] * normal[1]
    velocity = (before + size / (1.0 + RESTITUTION)) * normal
    if grip:
        tangent = np.array([-normal[1], normal[0]])
        surface = state[2] * tangent[0] + state[3] * tangent[1] - PUCK_RADIUS * state[4]
        velocity = velocity + surface * tangent
    return state[:2] - CONTACT * normal, velocity


@compiled
def resting_place(state: Array, standstill: float, constants: Array) -> Array:
    """Where a puck that hits nothing has slowed down to a speed, in [m]/[s]. State (5,). Shape (2,)."""
    moved = state.copy()
    speed = np.hypot(state[2], state[3])
    if speed > standstill:
        slide(moved, np.log(speed / standstill) / constants[3], constants)
    return moved[:2]
