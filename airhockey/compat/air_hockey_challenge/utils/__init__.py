"""Kinematics and transformations."""

from .kinematics import forward_kinematics, inverse_kinematics, jacobian
from .transformations import robot_to_world, world_to_robot

__all__ = ["forward_kinematics", "inverse_kinematics", "jacobian", "robot_to_world", "world_to_robot"]
