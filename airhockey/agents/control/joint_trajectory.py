"""A Cartesian trajectory turned into joint commands ahead of time: AQP along the path, slower where needed, smoothed."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.control.cartesian import CartesianTrajectory
from airhockey.agents.control.joint_controller import JointController, JointState
from airhockey.agents.control.kinematics import ArmKinematics

Array = NDArray[np.float64]

STRETCH = 1.15
"""By how much a trajectory that is too fast is slowed down before the next attempt (methods: 1.1 to 1.2)."""


@dataclass(frozen=True)
class JointTrajectory:
    """Joint commands at the control steps; row 0 is the first command, one step after planning.

    Attributes:
        positions: In [rad]. Shape (k, n).
        velocities: In [rad]/[s]. Shape (k, n).
        stretch: By how much the trajectory had to be slowed down.
    """

    positions: Array
    velocities: Array
    stretch: float

    def __len__(self) -> int:
        return len(self.positions)

    def state(self, kinematics: ArmKinematics, step: int) -> JointState:
        """The command of a step; after the end the last one."""
        index = min(step, len(self) - 1)
        return JointState.of(kinematics, self.positions[index], self.velocities[index])


def plan_joints(
    controller: JointController,
    make_trajectory: Callable[[float], CartesianTrajectory],
    anchor: Array | None = None,
    attempts: int = 10,
    budget: int = 120,
    smooth: bool = True,
) -> JointTrajectory | None:
    """Follow a Cartesian trajectory from the controller's present state, without moving it.

    Args:
        controller: Its state is where the plan starts, at rest or in motion.
        make_trajectory: The trajectory slowed down by a factor ≥ 1; it starts at the controller's tip position and
            velocity.
        anchor: Joint position that the null space is drawn to, in [rad]. Shape (n,).
        attempts: How often it may be slowed down.
        budget: Control steps that all attempts together may try: bounds the time this takes (about 0.1 ms each).
        smooth: Whether to smooth the joint path by a cubic spline.

    Returns:
        The joint commands, or None where no attempt could be followed exactly within the budget.
    """
    stretch = 1.0
    for _ in range(attempts):
        trajectory = make_trajectory(stretch)
        states = _follow(controller, trajectory, anchor, budget)
        if isinstance(states, list):
            positions = np.array([state.position for state in states])
            velocities = np.array([state.velocity for state in states])
            if smooth and len(states) > 2:
                positions, velocities = _smoothed(controller.state, positions, controller.dt)
            return JointTrajectory(positions, velocities, stretch)
        budget -= states
        if budget <= 0:
            return None
        stretch *= STRETCH
    return None


def _follow(
    controller: JointController, trajectory: CartesianTrajectory, anchor: Array | None, budget: int
) -> list[JointState] | int:
    """The states along a trajectory, or how many steps were tried before one could not be met."""
    dt, state, states = controller.dt, controller.state, []
    steps = int(np.ceil(trajectory.duration / dt - 1e-9))
    for k in range(1, steps + 1):
        if k > budget:
            return k
        state, exact = controller.next_state(state, *trajectory.at(k * dt), anchor)
        if not exact:
            return k
        states.append(state)
    return states


def _smoothed(start: JointState, positions: Array, dt: float) -> tuple[Array, Array]:
    """A cubic spline through the path, start velocity clamped, no acceleration at the end. Shapes (k, n), (k, n).

    With the slopes m_i at the knots p_i the spline is smooth where m_{i−1} + 4 m_i + m_{i+1} = 3 (p_{i+1} −
    p_{i−1})/Δt, and its last acceleration vanishes where m_{k−1} + 2 m_k = 3 (p_k − p_{k−1})/Δt.
    """
    k = len(positions)
    knots = np.vstack([start.position, positions])
    matrix = 4.0 * np.eye(k) + np.eye(k, k=1) + np.eye(k, k=-1)
    matrix[-1, -1] = 2.0
    right = np.empty_like(positions)
    right[:-1] = 3.0 * (knots[2:] - knots[:-2]) / dt
    right[-1] = 3.0 * (knots[-1] - knots[-2]) / dt
    right[0] -= start.velocity
    return positions, np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)
