"""`env_info["constraints"]`: the challenge's constraints as functions of the joints, with their Jacobians.

A constraint is violated where its value is positive. All is seen from the robot frame and computed with the nominal arm. Classes
and attributes are those of the official package, since agents read them and derive their own from them.
"""

import copy
from collections.abc import Iterator, KeysView
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from airhockey.envs.kernel.arm import Arm, arm_from_model
from airhockey.envs.kernel.chain import forward_kinematics, point_jacobian
from airhockey.envs.kernel.constraints import (
    ELBOW,
    HEIGHT_TOLERANCE,
    MIN_LINK_HEIGHT,
    WRIST,
    end_effector_constraints,
    joint_constraints,
    link_constraints,
)
from airhockey.envs.specs import IIWA, PLANAR, SOFT_LIMIT

Array = NDArray[np.float64]


def constraint_slices(arm: Arm) -> dict[str, slice]:
    """Where each constraint stands in the flat vector of all values that a control step leaves."""
    n = arm.mass.shape[0]
    slices = {
        "joint_pos_constr": slice(0, 2 * n),
        "joint_vel_constr": slice(2 * n, 4 * n),
        "ee_constr": slice(4 * n, 4 * n + 5),
    }
    if arm.universal_joint:
        slices["link_constr"] = slice(4 * n + 5, 4 * n + 7)
    return slices


class Constraint:
    """A constraint; subclasses set `_name` and give `_fun` and `_jacobian`.

    Attributes:
        output_dim: Number of values.
    """

    _name = ""

    def __init__(self, env_info: dict[str, Any], output_dim: int, **kwargs: Any) -> None:
        self._env_info = env_info
        self._n_joints = int(env_info["robot"]["n_joints"])
        self.output_dim = output_dim

    @property
    def name(self) -> str:
        """By which a `ConstraintList` knows it, for example "ee_constr"."""
        return self._name

    def fun(self, q: ArrayLike, dq: ArrayLike) -> Array:
        """Values at joint positions [rad] and velocities [rad/s], each of shape (n,). Shape (output_dim,)."""
        return self._fun(self._joints(q), self._joints(dq))

    def jacobian(self, q: ArrayLike, dq: ArrayLike) -> Array:
        """Derivative of the values by (q, q̇). Shape (output_dim, 2n)."""
        return self._jacobian(self._joints(q), self._joints(dq))

    def _fun(self, q: Array, dq: Array) -> Array:
        raise NotImplementedError(f"{type(self).__name__} defines no _fun(q, dq)")

    def _jacobian(self, q: Array, dq: Array) -> Array:
        raise NotImplementedError(f"{type(self).__name__} defines no _jacobian(q, dq)")

    def _joints(self, values: ArrayLike) -> Array:
        return np.ascontiguousarray(values, dtype=np.float64).reshape(self._n_joints)


class _OfTheArm(Constraint):
    """A constraint that compiled code evaluates, of the arm whose model `env_info` holds."""

    @cached_property
    def _arm(self) -> Arm:
        spec = PLANAR if self._n_joints == PLANAR.n_joints else IIWA
        return arm_from_model(spec, self._env_info["robot"]["robot_model"])

    def _kinematics(self, position: Array) -> tuple[Array, Array]:
        n = position.size
        positions, axes = np.empty((n + 1, 3)), np.empty((n + 2, 3))
        forward_kinematics(self._arm, position, positions, axes)
        return positions, axes

    @staticmethod
    def _point_jacobian(positions: Array, axes: Array, point: int) -> Array:
        jacobian = np.empty((3, positions.shape[0] - 1))
        point_jacobian(positions, axes, point, jacobian)
        return jacobian


class _JointLimits(_OfTheArm):
    """Something of the joints within the soft share of its limits.

    Attributes:
        joint_limits: Lower and upper bounds. Shape (2, n).
    """

    _of = ""

    def __init__(self, env_info: dict[str, Any], **kwargs: Any) -> None:
        super().__init__(env_info, 2 * int(env_info["robot"]["n_joints"]), **kwargs)
        self.joint_limits = SOFT_LIMIT * env_info["robot"][f"joint_{self._of}_limit"]

    def _fun(self, q: Array, dq: Array) -> Array:
        values = np.empty(4 * q.size)
        joint_constraints(self._arm, q, dq, values)
        return values[constraint_slices(self._arm)[self._name]]

    def _jacobian(self, q: Array, dq: Array) -> Array:
        derivative = np.vstack((np.eye(q.size), -np.eye(q.size)))
        nothing = np.zeros_like(derivative)
        return np.hstack((derivative, nothing) if self._of == "pos" else (nothing, derivative))


class JointPositionConstraint(_JointLimits):
    """Joint positions within their soft limits, in [rad]."""

    _name, _of = "joint_pos_constr", "pos"


class JointVelocityConstraint(_JointLimits):
    """Joint velocities within their soft limits, in [rad/s]."""

    _name, _of = "joint_vel_constr", "vel"


class _OfLinks(_OfTheArm):
    """A constraint on where parts of the arm are."""

    def __init__(self, env_info: dict[str, Any], output_dim: int, **kwargs: Any) -> None:
        super().__init__(env_info, output_dim, **kwargs)
        self._copies: dict[str, Any] = {}

    @property
    def robot_model(self) -> Any:
        """Its own copy of MuJoCo's model of the robot, made when first asked for."""
        return self._copied("robot_model")

    @property
    def robot_data(self) -> Any:
        """Its own copy of MuJoCo's data of the robot, made when first asked for."""
        return self._copied("robot_data")

    def _copied(self, key: str) -> Any:
        if key not in self._copies:
            self._copies[key] = copy.deepcopy(self._env_info["robot"][key])
        return self._copies[key]


class EndEffectorConstraint(_OfLinks):
    """The end-effector over the table and at its height.

    Attributes:
        x_lb, y_lb, y_ub, z_lb, z_ub: Bounds of its position in the robot frame, in [m].
    """

    _name = "ee_constr"

    def __init__(self, env_info: dict[str, Any], **kwargs: Any) -> None:
        super().__init__(env_info, 5, **kwargs)
        table, margin = env_info["table"], env_info["mallet"]["radius"]
        self.x_lb = -env_info["robot"]["base_frame"][0][0, 3] - (table["length"] / 2 - margin)
        self.y_lb = -(table["width"] / 2 - margin)
        self.y_ub = table["width"] / 2 - margin
        self.z_lb = env_info["robot"]["ee_desired_height"] - HEIGHT_TOLERANCE
        self.z_ub = env_info["robot"]["ee_desired_height"] + HEIGHT_TOLERANCE

    def _fun(self, q: Array, dq: Array) -> Array:
        values = np.empty(5)
        end_effector_constraints(self._kinematics(q)[0][-1], self._arm.desired_height, values)
        return values

    def _jacobian(self, q: Array, dq: Array) -> Array:
        positions, axes = self._kinematics(q)
        tip = self._point_jacobian(positions, axes, q.size)
        return np.hstack((np.stack((-tip[0], -tip[1], tip[1], -tip[2], tip[2])), np.zeros((5, q.size))))


class LinkConstraint(_OfLinks):
    """Wrist and elbow above the table (iiwa).

    Attributes:
        z_lb: Their lowest height in the robot frame, in [m].
    """

    _name = "link_constr"

    def __init__(self, env_info: dict[str, Any], **kwargs: Any) -> None:
        super().__init__(env_info, 2, **kwargs)
        self.z_lb = MIN_LINK_HEIGHT

    def _fun(self, q: Array, dq: Array) -> Array:
        values = np.empty(2)
        link_constraints(self._kinematics(q)[0], values)
        return values

    def _jacobian(self, q: Array, dq: Array) -> Array:
        positions, axes = self._kinematics(q)
        rows = np.stack([-self._point_jacobian(positions, axes, link)[2] for link in (WRIST, ELBOW)])
        return np.hstack((rows, np.zeros((2, q.size))))


class ConstraintList:
    """Constraints by name."""

    def __init__(self) -> None:
        self.constraints: dict[str, Any] = {}

    def keys(self) -> KeysView[str]:
        """The names, in the order in which they were added."""
        return self.constraints.keys()

    def get(self, key: str) -> Any:
        """One constraint; None for a name that is not there, as in the official package."""
        return self.constraints.get(key)

    def add(self, constraint: Any) -> None:
        """Add one under its name."""
        self.constraints[constraint.name] = constraint

    def delete(self, name: str) -> None:
        """Remove one."""
        del self.constraints[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.constraints)

    def fun(self, q: ArrayLike, dq: ArrayLike) -> dict[str, Array]:
        """The values of every constraint at joint positions [rad] and velocities [rad/s]."""
        return {name: constraint.fun(q, dq) for name, constraint in self.constraints.items()}

    def jacobian(self, q: ArrayLike, dq: ArrayLike) -> dict[str, Array]:
        """The Jacobian of every constraint, each of shape (dim, 2n)."""
        return {name: constraint.jacobian(q, dq) for name, constraint in self.constraints.items()}


def challenge_constraints(env_info: dict[str, Any]) -> ConstraintList:
    """All constraints of the challenge for the robot of `env_info`, in the official order."""
    result = ConstraintList()
    kinds: list[Any] = [JointPositionConstraint, JointVelocityConstraint, EndEffectorConstraint]
    if env_info["robot"]["n_joints"] == IIWA.n_joints:
        kinds.append(LinkConstraint)
    for kind in kinds:
        result.add(kind(env_info))
    return result
