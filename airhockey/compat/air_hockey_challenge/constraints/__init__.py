"""Constraints as functions of the joints."""

from .constraints import (
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
