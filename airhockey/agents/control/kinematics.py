"""Forward kinematics and Jacobians of both robots by Pinocchio, in the robot's own frame.

The model is built in code from `airhockey.envs.specs`: the same chain of links that the simulator compiles, without
masses.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from airhockey.envs.specs import IIWA, PLANAR, RobotSpec

Array = NDArray[np.float64]

ELBOW_LINK, WRIST_LINK = 4, 7
"""Links of the iiwa whose origins must stay above a height (challenge's section 5)."""


def spec_of(env_info: Mapping[str, Any]) -> RobotSpec:
    """The robot that `env_info` describes."""
    return IIWA if env_info["robot"]["n_joints"] == IIWA.n_joints else PLANAR


class ArmKinematics:
    """Where the rod tip is, and how fast each joint moves it.

    Attributes:
        spec: Dimensions and limits of the robot.
        n_joints: n.
        n_coordinates: How many coordinates of the rod tip the joints move: 3, or 2 on the planar robot, whose height
            is fixed.
        has_link_heights: Whether elbow and wrist heights are limited (iiwa).
    """

    def __init__(self, spec: RobotSpec) -> None:
        """Build the Pinocchio model of a robot.

        Args:
            spec: Dimensions of the robot.
        """
        self.spec = spec
        self.n_joints = spec.n_joints
        self.has_link_heights = spec.n_joints >= WRIST_LINK
        self.n_coordinates = 3 if self.has_link_heights else 2
        self._model, self._tip = _build_model(spec)
        self._data = self._model.createData()

    def position(self, q: Array) -> Array:
        """Position of the rod tip, in [m].

        Args:
            q: Joint positions, in [rad]. Shape (n,).

        Returns:
            Coordinates in the robot frame. Shape (3,).
        """
        pin.forwardKinematics(self._model, self._data, q)
        return np.array(pin.updateFramePlacement(self._model, self._data, self._tip).translation)

    def jacobian(self, q: Array) -> Array:
        """Position Jacobian of the rod tip, in [m]/[rad]. Shape (3, n)."""
        return np.array(
            pin.computeFrameJacobian(self._model, self._data, q, self._tip, pin.LOCAL_WORLD_ALIGNED)[:3], order="C"
        )

    def position_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """Both of the above, at the price of one pass. Shapes (3,), (3, n)."""
        jacobian = self.jacobian(q)
        return np.array(pin.updateFramePlacement(self._model, self._data, self._tip).translation), jacobian

    def rotation(self, q: Array) -> Array:
        """Rotation of the rod: its axes as columns, in the robot frame. Shape (3, 3)."""
        pin.forwardKinematics(self._model, self._data, q)
        return np.array(pin.updateFramePlacement(self._model, self._data, self._tip).rotation)

    def link_heights(self, q: Array) -> Array:
        """Heights of elbow and wrist above the robot's base, in [m]; empty on the planar robot. Shape (2,) or (0,)."""
        if not self.has_link_heights:
            return np.empty(0)
        pin.forwardKinematics(self._model, self._data, q)
        return self._heights()

    def link_heights_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """Heights of elbow and wrist, and how the joints move them. Shapes (2,), (2, n), or (0,), (0, n)."""
        if not self.has_link_heights:
            return np.empty(0), np.empty((0, self.n_joints))
        pin.computeJointJacobians(self._model, self._data, q)
        rows = [
            pin.getJointJacobian(self._model, self._data, link, pin.LOCAL_WORLD_ALIGNED)[2]
            for link in (ELBOW_LINK, WRIST_LINK)
        ]
        return self._heights(), np.array(rows)

    def _heights(self) -> Array:
        return np.array([self._data.oMi[link].translation[2] for link in (ELBOW_LINK, WRIST_LINK)])


def _build_model(spec: RobotSpec) -> tuple[pin.Model, int]:
    """A chain of joints about their own z axes, and the index of the rod tip's frame at its end."""
    model = pin.Model()
    joint = 0
    for number, link in enumerate(spec.links, start=1):
        joint = model.addJoint(joint, pin.JointModelRZ(), _placement(link.position, link.quaternion), f"joint_{number}")
    tip = pin.SE3.Identity()
    for body in spec.tip:
        tip = tip * _placement(body.position, (1.0, 0.0, 0.0, 0.0))
    return model, model.addFrame(pin.Frame("ee", joint, 0, tip, pin.FrameType.OP_FRAME))


def _placement(position: tuple[float, float, float], quaternion: tuple[float, float, float, float]) -> pin.SE3:
    w, x, y, z = np.asarray(quaternion) / np.linalg.norm(quaternion)
    return pin.SE3(pin.Quaternion(w, x, y, z).toRotationMatrix(), np.asarray(position, dtype=float))
