"""The ATACOM controller: actions in, joint commands out, and every command within the constraints.

The command is the state: it is integrated from the first observation on, and noise in later ones cannot move it.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.atacom.chain import Chain, TaskMotion, chain_of, task_coordinates
from airhockey.agents.atacom.following import Gains, action_of_joints, action_of_tip, gains_of
from airhockey.agents.atacom.limits import Limits, limits_of
from airhockey.agents.atacom.parameters import AtacomParameters, atacom_parameters
from airhockey.agents.atacom.tangent import constraint_rows, tangent_control
from airhockey.agents.compiling import compiled
from airhockey.agents.small_matrices import product
from airhockey.envs.specs import RobotSpec

Array = NDArray[np.float64]

_NUDGE = 1e-4
"""Time over which J̇ q̇ is differenced, in [s]."""


class AtacomController:
    """A policy's actions on the tangent space, integrated to joint commands.

    Attributes:
        spec: Of the robot.
        dt: Length of a control step, in [s].
        q, velocity: The last command, in [rad] and [rad]/[s]. Shapes (n,), (n,).
    """

    def __init__(self, spec: RobotSpec, dt: float = 0.02, parameters: AtacomParameters | None = None) -> None:
        """Set up and compile.

        Args:
            spec: Of the robot.
            dt: Length of a control step, in [s].
            parameters: By default the package's own for the robot.
        """
        p = parameters or atacom_parameters(spec)
        self.spec, self.dt = spec, dt
        self._substeps = p.substeps
        self._model = Model(chain_of(spec), limits_of(spec, p), gains_of(spec, p))
        self.reset(np.array(spec.start))
        self.step(np.zeros(2))
        self.step(np.zeros(spec.n_joints))
        self.reset(np.array(spec.start))

    def reset(self, q: Array, velocity: Array | None = None) -> None:
        """Take a joint position (the first observation) as the command.

        Args:
            q: In [rad]. Shape (n,).
            velocity: In [rad]/[s]; at rest by default. Shape (n,).
        """
        self.q = np.array(q, dtype=np.float64)
        self.velocity = np.zeros_like(self.q) if velocity is None else np.array(velocity, dtype=np.float64)
        self._look()

    def step(self, action: Array) -> Array:
        """One control step.

        Args:
            action: Each entry in [−1, 1]: of the tip's velocity, shape (2,), or of the joints' velocities, shape (n,).

        Returns:
            Joint command for interpolation order 3: position [rad] and velocity [rad]/[s]. Shape (2, n).
        """
        clipped = np.clip(np.asarray(action, dtype=np.float64), -1.0, 1.0)
        self.q, self.velocity = integrate(self._model, clipped, self.q, self.velocity, self.dt, self._substeps)
        self._look()
        return np.array([self.q, self.velocity])

    def constraint_values(self) -> Array:
        """c = k + K_f k̇ of the command, with the margins: not above 0. Shape (K,)."""
        values, rows = task_coordinates(self._model.chain, self.q)
        zero = np.zeros(len(values))
        return np.asarray(constraint_rows(self._model.limits, values, rows, zero, self.q, self.velocity)[0])

    def _look(self) -> None:
        """Where the command puts the tip: `tip` [m] and `tip_velocity` [m]/[s] in the robot frame. Shapes (2,), (2,)."""
        values, rows = task_coordinates(self._model.chain, self.q)
        self.tip, self.tip_velocity = values[:2], rows[:2] @ self.velocity


class Model(NamedTuple):
    """What a step is computed from: the arm, what it must keep, how it follows."""

    chain: Chain
    limits: Limits
    gains: Gains


@compiled
def integrate(model: Model, action: Array, q: Array, velocity: Array, dt: float, substeps: int) -> tuple[Array, Array]:
    """The command after a control step, in [rad] and [rad]/[s]. Shapes (n,), (n,)."""
    chain, limits, gains = model
    h = dt / substeps
    q, velocity = q.copy(), velocity.copy()
    for _ in range(substeps):
        values, rows = task_coordinates(chain, q)
        ahead = task_coordinates(chain, q + _NUDGE * velocity)[1]
        drift = product(ahead - rows, velocity) / _NUDGE
        if action.size == 2:
            wanted = action_of_tip(action, gains, TaskMotion(values, rows, drift), q, velocity)
        else:
            wanted = action_of_joints(action, gains, velocity)
        _, b, jacobian, a = constraint_rows(limits, values, rows, drift, q, velocity)
        acceleration = limits.acceleration * tangent_control(wanted, b, jacobian, a)
        q += h * velocity + 0.5 * h * h * acceleration
        velocity += h * acceleration
    return q, velocity
