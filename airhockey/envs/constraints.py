"""`env_info["constraints"]`: the challenge's constraints as functions of the joints, with their Jacobians.

A constraint is violated where its value is positive. All is seen from the robot frame and computed with the nominal arm.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from airhockey.envs.kernel.arm import Arm
from airhockey.envs.kernel.chain import forward_kinematics, point_jacobian
from airhockey.envs.kernel.constraints import (
    ELBOW,
    WRIST,
    end_effector_constraints,
    joint_constraints,
    link_constraints,
)

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
    """One constraint of the list; `fun` and `jacobian` are what agents call.

    Attributes:
        name: For example "ee_constr".
        output_dim: Number of values.
    """

    def __init__(self, name: str, arm: Arm) -> None:
        self.name = name
        self._arm = arm
        self._slice = constraint_slices(arm)[name]
        self.output_dim = self._slice.stop - self._slice.start

    def fun(self, q: ArrayLike, dq: ArrayLike) -> Array:
        """Values at joint positions [rad] and velocities [rad/s], each of shape (n,). Shape (output_dim,)."""
        position, velocity = self._joints(q), self._joints(dq)
        if self.name.startswith("joint"):
            values = np.empty(4 * position.size)
            joint_constraints(self._arm, position, velocity, values)
            return values[self._slice]
        positions, _ = self._kinematics(position)
        values = np.empty(self.output_dim)
        if self.name == "ee_constr":
            end_effector_constraints(positions[-1], self._arm.desired_height, values)
        else:
            link_constraints(positions, values)
        return values

    def jacobian(self, q: ArrayLike, dq: ArrayLike) -> Array:
        """Derivative of the values by (q, q̇). Shape (output_dim, 2n)."""
        position = self._joints(q)
        n = position.size
        result = np.zeros((self.output_dim, 2 * n))
        if self.name.startswith("joint"):
            column = 0 if self.name == "joint_pos_constr" else n
            result[:n, column : column + n] = np.eye(n)
            result[n:, column : column + n] = -np.eye(n)
            return result
        positions, axes = self._kinematics(position)
        if self.name == "ee_constr":
            tip = self._point_jacobian(positions, axes, n)
            result[:, :n] = np.stack((-tip[0], -tip[1], tip[1], -tip[2], tip[2]))
        else:
            result[:, :n] = [-self._point_jacobian(positions, axes, link)[2] for link in (WRIST, ELBOW)]
        return result

    def _joints(self, values: ArrayLike) -> Array:
        return np.ascontiguousarray(values, dtype=np.float64).reshape(self._arm.mass.shape)

    def _kinematics(self, position: Array) -> tuple[Array, Array]:
        n = position.size
        positions, axes = np.empty((n + 1, 3)), np.empty((n + 2, 3))
        forward_kinematics(self._arm, position, positions, axes)
        return positions, axes

    def _point_jacobian(self, positions: Array, axes: Array, point: int) -> Array:
        jacobian = np.empty((3, positions.shape[0] - 1))
        point_jacobian(positions, axes, point, jacobian)
        return jacobian


class ConstraintList:
    """All constraints of a robot, by name."""

    def __init__(self, arm: Arm) -> None:
        self.constraints = {name: Constraint(name, arm) for name in constraint_slices(arm)}

    def keys(self) -> list[str]:
        """The names, in the order of the official package."""
        return list(self.constraints)

    def get(self, name: str) -> Constraint:
        """One constraint; raises `KeyError` for a name that the robot does not have."""
        return self.constraints[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.constraints)

    def fun(self, q: ArrayLike, dq: ArrayLike) -> dict[str, Array]:
        """The values of every constraint at joint positions [rad] and velocities [rad/s]."""
        return {name: constraint.fun(q, dq) for name, constraint in self.constraints.items()}

    def jacobian(self, q: ArrayLike, dq: ArrayLike) -> dict[str, Array]:
        """The Jacobian of every constraint, each of shape (dim, 2n)."""
        return {name: constraint.jacobian(q, dq) for name, constraint in self.constraints.items()}
