"""The constraints of `env_info`, and what agents derive their own from."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


class Constraint:
    """A constraint, violated where its value is positive; subclasses give `_fun` and `_jacobian`.

    Attributes:
        output_dim: Number of values.
    """

    def __init__(self, env_info: dict[str, Any], output_dim: int, **kwargs: Any) -> None:
        self._env_info, self._name, self.output_dim = env_info, "", output_dim

    @property
    def name(self) -> str:
        """By which a `ConstraintList` knows it."""
        return self._name

    def fun(self, q: ArrayLike, dq: ArrayLike) -> Array:
        """Values at joint positions and velocities. Shape (output_dim,)."""
        return self._fun(np.asarray(q), np.asarray(dq))

    def jacobian(self, q: ArrayLike, dq: ArrayLike) -> Array:
        """Derivative by both. Shape (output_dim, 2n)."""
        return self._jacobian(np.asarray(q), np.asarray(dq))

    def _fun(self, q: Array, dq: Array) -> Array:
        raise NotImplementedError

    def _jacobian(self, q: Array, dq: Array) -> Array:
        raise NotImplementedError


class _OfTheChallenge(Constraint):
    """One of the challenge's own."""

    _own_name = ""

    def __init__(self, env_info: dict[str, Any], **kwargs: Any) -> None:
        self._own = env_info["constraints"].get(self._own_name)
        super().__init__(env_info, self._own.output_dim, **kwargs)
        self._name = self._own_name

    def _fun(self, q: Array, dq: Array) -> Array:
        return np.asarray(self._own.fun(q, dq))

    def _jacobian(self, q: Array, dq: Array) -> Array:
        return np.asarray(self._own.jacobian(q, dq))


class JointPositionConstraint(_OfTheChallenge):
    """Joint positions within their limits."""

    _own_name = "joint_pos_constr"


class JointVelocityConstraint(_OfTheChallenge):
    """Joint velocities within their limits."""

    _own_name = "joint_vel_constr"


class EndEffectorConstraint(_OfTheChallenge):
    """The end-effector over the table and at its height."""

    _own_name = "ee_constr"


class LinkConstraint(_OfTheChallenge):
    """Wrist and elbow above the table."""

    _own_name = "link_constr"


class ConstraintList:
    """Constraints by name."""

    def __init__(self) -> None:
        self.constraints: dict[str, Any] = {}

    def keys(self) -> Any:
        """The names."""
        return self.constraints.keys()

    def get(self, key: str) -> Any:
        """One of them, or None."""
        return self.constraints.get(key)

    def add(self, constraint: Any) -> None:
        """Add one under its name."""
        self.constraints[constraint.name] = constraint

    def delete(self, name: str) -> None:
        """Remove one."""
        del self.constraints[name]

    def fun(self, q: ArrayLike, dq: ArrayLike) -> dict[str, Array]:
        """All values."""
        return {name: constraint.fun(q, dq) for name, constraint in self.constraints.items()}

    def jacobian(self, q: ArrayLike, dq: ArrayLike) -> dict[str, Array]:
        """All Jacobians."""
        return {name: constraint.jacobian(q, dq) for name, constraint in self.constraints.items()}
