"""The constraints of `env_info`, and what agents derive their own from."""

from airhockey.envs.constraints import (
    Constraint,
    ConstraintList,
    EndEffectorConstraint,
    JointPositionConstraint,
    JointVelocityConstraint,
    LinkConstraint,
)

__all__ = [
    "Constraint",
    "ConstraintList",
    "EndEffectorConstraint",
    "JointPositionConstraint",
    "JointVelocityConstraint",
    "LinkConstraint",
]
