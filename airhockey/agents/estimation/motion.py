"""How a puck moves on its own: it slides with damping, and bounces off the rims.

The state is (x, y, ẋ, ẏ, ω) in the table frame: origin at the table's centre, x towards the opponent; in [m], [m]/[s]
and [rad]/[s]. The compiled functions below take the constants as one array, `PuckMotion.constants`.

A bounce is instantaneous. The normal velocity turns round and shrinks by the restitution e. The tangential impulse is
a share κ of the slip s = v_t ± rω between puck and rim (a uniform disc: a unit of velocity taken from v_t adds two to
rω):

    v_n ← −e v_n,    v_t ← v_t − κ s,    rω ← rω ∓ 2κ s
"""

from dataclasses import dataclass
from functools import cache
from math import exp
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled, in_place
from airhockey.agents.parameters import load_parameters
from airhockey.envs.specs import PUCK, TABLE

Array = NDArray[np.float64]

_X, _Y, _GOAL, _DECAY, _SPIN_DECAY, _E, _KAPPA, _R = range(8)  # layout of the constants


@dataclass(frozen=True)
class PuckMotion:
    """Constants of the puck's motion, identified from the simulator by scripts/identify_bounces.py.

    Attributes:
        restitution: e, share of the normal velocity that a bounce keeps.
        slip_impulse: κ, share of the slip that a bounce takes from the tangential velocity.
        rim_give: How much further than the rim's edge the puck's rim turns round on average, in [m].
        restitution_spread, slip_spread: Standard deviations of e and κ, from the residuals of the identification.
    """

    restitution: float
    slip_impulse: float
    rim_give: float
    restitution_spread: float
    slip_spread: float

    @property
    def constants(self) -> Array:
        """What the compiled functions need. Shape (8,)."""
        return np.array(
            [
                TABLE.length / 2 - PUCK.radius + self.rim_give,
                TABLE.width / 2 - PUCK.radius + self.rim_give,
                TABLE.goal_width / 2,
                PUCK.slide_damping / PUCK.mass,
                PUCK.yaw_damping / PUCK.inertia[2],
                self.restitution,
                self.slip_impulse,
                PUCK.radius,
            ]
        )


@cache
def puck_motion() -> PuckMotion:
    """The identified constants, from `bounces.yaml` beside this module."""
    return load_parameters(PuckMotion, "bounces", Path(__file__).parent)


@in_place
def decay_over(duration: float, constants: Array) -> tuple[float, float, float]:
    """What a duration without bounces leaves of the velocity, how far a unit of velocity goes in it [s], and what of the spin."""
    keep = exp(-constants[_DECAY] * duration)
    return keep, (1.0 - keep) / constants[_DECAY], exp(-constants[_SPIN_DECAY] * duration)


@in_place
def slide_by(state: Array, decay: tuple[float, float, float]) -> None:
    """Move a state along without bounces, in place, over a duration of which `decay_over` is known."""
    keep, travel, keep_spin = decay
    state[0] += state[2] * travel
    state[1] += state[3] * travel
    state[2] *= keep
    state[3] *= keep
    state[4] *= keep_spin


@in_place
def slide(state: Array, duration: float, constants: Array) -> None:
    """Move a state along by a duration without bounces, in place."""
    slide_by(state, decay_over(duration, constants))


@in_place
def bounce(state: Array, constants: Array) -> bool:
    """Reflect a state that has passed a rim, in place, except in a goal's mouth. Returns whether it bounced."""
    bounced = False
    for axis in range(2):
        limit = constants[_X] if axis == 0 else constants[_Y]
        side = 1.0 if state[axis] > 0 else -1.0
        beyond = side * state[axis] - limit
        outward = side * state[2 + axis]
        if beyond <= 0.0 or outward <= 0.0 or (axis == 0 and abs(state[1]) < constants[_GOAL]):
            continue
        # Velocity of the puck's edge at the rim: y-rims at (0, ±r) see ẋ ∓ rω, x-rims at (±r, 0) see ẏ ± rω.
        turn = side if axis == 0 else -side
        slip = state[3 - axis] + turn * constants[_R] * state[4]
        state[2 + axis] *= -constants[_E]
        state[3 - axis] -= constants[_KAPPA] * slip
        state[4] -= turn * 2.0 * constants[_KAPPA] * slip / constants[_R]
        state[axis] = side * (limit - constants[_E] * beyond)
        bounced = True
    return bounced


@in_place
def advance(state: Array, duration: float, constants: Array) -> int:
    """Move a state along by a duration with bounces, in place, in pieces of at most 5 ms. Returns their number."""
    pieces = pieces_of(duration)
    return advance_by(state, pieces, decay_over(duration / pieces, constants), constants)


@in_place
def pieces_of(duration: float) -> int:
    """Into how many pieces of at most 5 ms a duration is divided."""
    return max(1, int(np.ceil(duration / 0.005 - 1e-9)))


@in_place
def advance_by(state: Array, pieces: int, decay: tuple[float, float, float], constants: Array) -> int:
    """Move a state along by pieces with bounces, in place, where `decay_over` a piece is known. Returns their number."""
    bounces = 0
    for _ in range(pieces):
        slide_by(state, decay)
        if bounce(state, constants):
            bounces += 1
    return bounces


@compiled
def transition(state: Array, duration: float, constants: Array) -> tuple[Array, Array, int]:
    """A state after a duration, its derivative by the state, and the number of bounces.

    Across bounces the derivative is a one-sided difference.

    Args:
        state: Shape (5,).
        duration: In [s].
        constants: `PuckMotion.constants`.

    Returns:
        The new state (5,), ∂new/∂old (5, 5), and how often the puck bounced.
    """
    keep, travel, spin = decay_over(duration, constants)
    after = state.copy()
    bounces = advance(after, duration, constants)
    jacobian = np.zeros((5, 5))
    if bounces == 0:
        for i in range(2):
            jacobian[i, i] = 1.0
            jacobian[i, i + 2] = travel
            jacobian[i + 2, i + 2] = keep
        jacobian[4, 4] = spin
        return after, jacobian, bounces
    for j in range(5):
        step = 1e-6
        moved = state.copy()
        moved[j] += step
        advance(moved, duration, constants)
        for i in range(5):
            jacobian[i, j] = (moved[i] - after[i]) / step
    return after, jacobian, bounces
