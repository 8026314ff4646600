"""From "where the rod tip should be one step ahead" to a joint command that is always within the robot's limits.

The controller never looks at the joints again after the first observation: its own commands are the state (thesis,
4.2.5), which is why noise on the joint observations cannot reach it. Positions follow velocities by the thesis's
equation 4.1.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.control.aqp import AnchoredQp, VelocityLimits
from airhockey.agents.control.bounds import JointBounds
from airhockey.agents.control.kinematics import ArmKinematics
from airhockey.agents.control.parameters import ControlParameters, control_parameters
from airhockey.agents.control.qp import make_solver
from airhockey.agents.control.speed_limit import largest_speed
from airhockey.agents.control.workspace import Workspace

Array = NDArray[np.float64]


@dataclass(frozen=True)
class JointState:
    """A joint command, and where it puts the rod tip.

    Attributes:
        position: In [rad]. Shape (n,).
        velocity: In [rad]/[s]. Shape (n,).
        tip: Rod tip in the robot frame, in [m]. Shape (2,).
        tip_velocity: In [m]/[s]. Shape (2,).
    """

    position: Array
    velocity: Array
    tip: Array
    tip_velocity: Array

    @classmethod
    def of(cls, kinematics: ArmKinematics, position: Array, velocity: Array) -> "JointState":
        """The state with these joint positions and velocities. Shapes (n,), (n,)."""
        tip, jacobian = kinematics.position_and_jacobian(position)
        return cls(position, velocity, tip[:2], jacobian[:2] @ velocity)

    def as_action(self) -> Array:
        """The command for interpolation order 3, a fresh array. Shape (2, n)."""
        return np.array([self.position, self.velocity])


class JointController:
    """Tracks Cartesian targets in the plane of the table; slows down or brakes where a target is too fast.

    Attributes:
        kinematics: Of the robot.
        workspace: Where the rod tip may be.
        dt: Length of a control step, in [s].
        parameters: Margins and weights.
        state: The last command.
        height: Height that the rod tip is commanded to, in [m].
        exact: Whether the last step followed its target exactly, rather than as nearly as the limits allow.
    """

    def __init__(
        self,
        kinematics: ArmKinematics,
        workspace: Workspace,
        dt: float = 0.02,
        parameters: ControlParameters | None = None,
    ) -> None:
        """Set up solver and bounds, and run each path once so that the first step in a game is not slow.

        Args:
            kinematics: Of the robot.
            workspace: Where the rod tip may be.
            dt: Length of a control step, in [s].
            parameters: By default the package's own for the robot.
        """
        spec = kinematics.spec
        self.kinematics, self.workspace, self.dt = kinematics, workspace, dt
        self.parameters = p = parameters or control_parameters(spec)
        self._bounds = JointBounds.of(spec, p.position_share, p.velocity_share, p.acceleration_share, dt)
        self._qp = AnchoredQp(np.array(p.anchor_weights), make_solver(p.solver))
        self._posture = np.array(p.anchor)
        self.height = spec.desired_height
        self.exact = True
        self.reset(np.array(spec.start))
        self._warm_up()

    def reset(self, q: Array, velocity: Array | None = None) -> None:
        """Take a joint position (the first observation) as the state.

        Args:
            q: In [rad]. Shape (n,).
            velocity: In [rad]/[s]; at rest by default. Shape (n,).
        """
        at_rest = np.zeros(len(q))
        self.state = JointState.of(self.kinematics, np.array(q), at_rest if velocity is None else np.array(velocity))

    def tip_position(self) -> Array:
        """Commanded position of the rod tip in the robot frame, in [m]. Shape (2,)."""
        return self.state.tip

    def tip_velocity(self) -> Array:
        """Commanded velocity of the rod tip in the robot frame, in [m]/[s]. Shape (2,)."""
        return self.state.tip_velocity

    def step(self, target: Array, velocity: Array | None = None, anchor: Array | None = None) -> Array:
        """Move towards a target one step ahead.

        Args:
            target: Rod tip at the end of the coming step, in the robot frame, in [m]. Shape (2,).
            velocity: Its velocity then, in [m]/[s]; by default the way to the target over Δt (thesis). Shape (2,).
            anchor: Joint position that the null space is drawn to, in [rad]; by default a comfortable one. Shape (n,).

        Returns:
            Joint command. Shape (2, n).
        """
        self.state, self.exact = self.next_state(self.state, target, velocity, anchor)
        return self.state.as_action()

    def brake(self) -> Array:
        """Bring the rod tip to rest as fast as the limits allow. Returns the joint command. Shape (2, n)."""
        self.state, self.exact = self._advance(self.state, np.zeros(2), None)
        return self.state.as_action()

    def hold(self) -> Array:
        """Stay at the last commanded position, at rest. Returns the joint command. Shape (2, n)."""
        self.state = JointState.of(self.kinematics, self.state.position, np.zeros_like(self.state.velocity))
        return self.state.as_action()

    def next_state(
        self, state: JointState, target: Array, velocity: Array | None = None, anchor: Array | None = None
    ) -> tuple[JointState, bool]:
        """What `step` would command from a state, and whether it meets the target exactly. Changes nothing."""
        dt, target = self.dt, self.workspace.clip(target)
        if velocity is None:
            return self._advance(state, (target - state.tip) / dt, anchor)
        # Ending the step with the target's velocity leaves this error, of which a share is removed (all of it in two
        # steps at a gain of 1).
        error = target - state.tip - 0.5 * dt * (state.tip_velocity + velocity)
        return self._advance(state, velocity + self.parameters.position_gain * error / dt, anchor)

    def _advance(self, state: JointState, tip_velocity: Array, anchor: Array | None) -> tuple[JointState, bool]:
        """One step whose end has a given tip velocity (2,), as nearly as the limits allow."""
        dt, m = self.dt, self.kinematics.n_coordinates
        ahead = state.position + dt * state.velocity  # the end of the step if the present velocity lasts
        position, jacobian = self.kinematics.position_and_jacobian(ahead)
        present = jacobian @ state.velocity
        edges = self.workspace.velocity_bounds(position[:2] - 0.5 * dt * present[:2])
        wanted = np.empty(m)
        wanted[:2] = np.minimum(np.maximum(tip_velocity, edges[0]), edges[1])
        if m == 3:  # half of the change of velocity moves the tip as well
            error = self.height - position[2] + 0.5 * dt * present[2]
            wanted[2] = self.parameters.position_gain * error / dt
        pull = self.parameters.anchor_gain * ((self._posture if anchor is None else anchor) - state.position)
        limits = self._limits(state, ahead)
        velocity = self._qp.solve(jacobian[:m], wanted, pull, limits)
        exact = velocity is not None
        if velocity is None:
            velocity = self._nearest(jacobian, wanted, pull, limits, edges)
        moved = state.position + 0.5 * dt * (state.velocity + velocity)  # (4.1)
        return JointState.of(self.kinematics, moved, velocity), exact

    def _nearest(self, jacobian: Array, wanted: Array, pull: Array, limits: VelocityLimits, edges: Array) -> Array:
        """The joint velocity within the limits that comes nearest to the wanted velocity of the tip. Shape (n,)."""
        j = jacobian[: len(wanted)]
        wanted[:2] = self._slowed(j, wanted[:2])
        tracking = self._tracking(wanted[:2], len(wanted))
        inside = limits.with_rows(np.vstack([j[:2], -j[:2]]), np.concatenate([edges[0], -edges[1]]))
        for soft in (inside, limits):  # braking as hard as the joints can may not be enough for the edges
            velocity = self._qp.solve_relaxed(j, wanted, pull, soft, tracking)
            if velocity is not None:
                return velocity
        # Only the height rows can contradict the box now: keep the box, and stop.
        return np.clip(np.zeros_like(pull), limits.lower, limits.upper)

    def _slowed(self, jacobian: Array, tip_velocity: Array) -> Array:
        """The tip velocity at a speed that the joints can reach, so that direction is not traded for speed."""
        speed = float(np.hypot(*tip_velocity))
        if speed < 1e-6:
            return tip_velocity
        direction = np.zeros(len(jacobian))
        direction[:2] = tip_velocity / speed
        return tip_velocity * min(1.0, largest_speed(jacobian, direction, *self._bounds.velocity) / speed)

    def _limits(self, state: JointState, ahead: Array) -> VelocityLimits:
        lower, upper = self._bounds.velocities(state.position, state.velocity)
        heights, rows = self.kinematics.link_heights_and_jacobian(ahead)
        p = self.parameters
        return VelocityLimits(lower, upper, rows, -p.link_height_gain * (heights - p.link_height))

    def _tracking(self, tip_velocity: Array, m: int) -> Array:
        """Weights of errors of the tip's velocity: along the asked direction, across it, vertically. Shape (m, m)."""
        p = self.parameters
        weights = np.eye(m)
        speed = float(np.hypot(*tip_velocity))
        if speed > 1e-6:
            along = tip_velocity / speed
            weights[:2, :2] = p.sideways_weight * np.eye(2) + (1.0 - p.sideways_weight) * np.outer(along, along)
        if m == 3:
            weights[2, 2] = p.height_weight
        return p.tracking_weight * weights

    def _warm_up(self) -> None:
        """First calls load, compile and allocate: make them before the game."""
        start = self.state
        self.step(self.tip_position() + np.array([0.001, 0.0]))
        self.step(self.tip_position() + np.array([1.0, 0.0]), np.array([9.0, 0.0]))
        self.brake()
        self.state, self.exact = start, True
