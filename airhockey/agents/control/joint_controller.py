"""From "where the rod tip should be one step ahead" to a joint command that is always within the robot's limits.

The controller never looks at the joints again after the first observation: its own commands are the state (thesis,
4.2.5), which is why noise on the joint observations cannot reach it. Positions follow velocities by the thesis's
equation 4.1.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.control.aqp import AnchoredQp
from airhockey.agents.control.kinematics import ArmKinematics
from airhockey.agents.control.kinematics_choice import chosen_kinematics
from airhockey.agents.control.parameters import ControlParameters, control_parameters
from airhockey.agents.control.qp import DEFAULT, make_solver
from airhockey.agents.control.tip_velocity_control import (
    Demand,
    advance,
    advance_to,
    demand,
    end_state,
    relaxed_demand,
    step_model,
    stopping,
    tip_velocity_to,
)
from airhockey.agents.control.workspace import Workspace
from airhockey.agents.table import to_robot

Array = NDArray[np.float64]


class JointState(NamedTuple):
    """A joint command, and where it puts the rod tip.

    Attributes:
        values: All of it, as `tip_velocity_control.advance` takes and gives it. Shape (2 n + 4,).
    """

    values: Array

    @classmethod
    def of(cls, kinematics: ArmKinematics, position: Array, velocity: Array) -> "JointState":
        """The state with these joint positions and velocities. Shapes (n,), (n,)."""
        tip, jacobian = kinematics.position_and_jacobian(position)
        return cls(np.concatenate([position, velocity, tip[:2], jacobian[:2] @ velocity]))

    @property
    def position(self) -> Array:
        """Of the joints, in [rad]. Shape (n,)."""
        return self.values[: len(self.values) // 2 - 2]

    @property
    def velocity(self) -> Array:
        """Of the joints, in [rad]/[s]. Shape (n,)."""
        return self.values[len(self.values) // 2 - 2 : -4]

    @property
    def tip(self) -> Array:
        """Rod tip in the robot frame, in [m]. Shape (2,)."""
        return self.values[-4:-2]

    @property
    def tip_velocity(self) -> Array:
        """In [m]/[s]. Shape (2,)."""
        return self.values[-2:]

    def as_action(self) -> Array:
        """The command for interpolation order 3, a fresh array. Shape (2, n)."""
        return self.values[:-4].copy().reshape(2, -1)


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
        self.parameters = p = parameters or control_parameters(spec)
        self.kinematics, self.workspace, self.dt = chosen_kinematics(kinematics, p.kinematics), workspace, dt
        self._model = step_model(spec, p, workspace, dt)
        # The package's own solver and kinematics are parts of the compiled step.
        compiled = p.solver == DEFAULT and self.kinematics is kinematics
        self._qp = None if compiled else AnchoredQp(np.array(p.anchor_weights), make_solver(p.solver))
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

    def move(self, target: Array, velocity: Array | None = None, anchor: Array | None = None) -> Array:
        """The same for a target in the table frame."""
        return self.step(to_robot(target), velocity, anchor)

    def brake(self) -> Array:
        """Bring the rod tip to rest as fast as the limits allow. Returns the joint command. Shape (2, n)."""
        self.state, self.exact = self._advance(self.state, np.zeros(2), self._posture)
        return self.state.as_action()

    def hold(self) -> Array:
        """Stay at the last commanded position, at rest. Returns the joint command. Shape (2, n)."""
        self.state = JointState.of(self.kinematics, self.state.position, np.zeros_like(self.state.velocity))
        return self.state.as_action()

    def next_state(
        self, state: JointState, target: Array, velocity: Array | None = None, anchor: Array | None = None
    ) -> tuple[JointState, bool]:
        """What `step` would command from a state, and whether it meets the target exactly. Changes nothing."""
        if anchor is None:
            anchor = self._posture
        if self._qp is None:
            after = np.empty(state.values.size)
            return JointState(after), advance_to(state.values, target, velocity, anchor, self._model, after)
        return self._advance(state, tip_velocity_to(state.values[-4:], target, velocity, self._model), anchor)

    def _advance(self, state: JointState, tip_velocity: Array, anchor: Array) -> tuple[JointState, bool]:
        """One step whose end has a given tip velocity (2,), as nearly as the limits allow."""
        if self._qp is None:
            after = np.empty(state.values.size)
            return JointState(after), advance(state.values, tip_velocity, anchor, self._model, after)
        model = self._model[0]
        asked = demand(state.position, state.velocity, tip_velocity, anchor, model)
        end = state.position + self.dt * state.velocity
        asked = asked._replace(jacobian=self.kinematics.jacobian(end)[: len(asked.jacobian)])
        new_velocity = self._qp.solve(asked.jacobian, asked.velocity, asked.anchor, asked.limits)
        exact = new_velocity is not None
        if new_velocity is None:
            new_velocity = self._nearest(self._qp, asked)
        after = np.empty(state.values.size)
        end_state(state.values, new_velocity, model, after)
        return JointState(after), exact

    def _nearest(self, qp: AnchoredQp, asked: Demand) -> Array:
        """`joint_velocity_for` by another solver, where what is asked cannot be done. Shape (n,)."""
        soft, tracking = relaxed_demand(asked, self._model[0])
        for limits in (soft.limits, asked.limits):
            velocity = qp.solve_relaxed(soft.jacobian, soft.velocity, soft.anchor, limits, tracking)
            if velocity is not None:
                return velocity
        return np.asarray(stopping(asked.limits))

    def _warm_up(self) -> None:
        """First calls load, compile and allocate: make them before the game."""
        start = self.state
        self.step(self.tip_position() + np.array([0.001, 0.0]))
        self.step(self.tip_position() + np.array([1.0, 0.0]), np.array([9.0, 0.0]))
        self.brake()
        self.state, self.exact = start, True
