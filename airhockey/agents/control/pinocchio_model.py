"""The arm as a Pinocchio model: kinematics by Pinocchio (`--set control.kinematics=pinocchio`), and whatever else it can do.

It is built in code from `airhockey.envs.specs`: the same chain of links that the simulator compiles, without masses.
"""

from typing import cast

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from airhockey.agents.control.kinematics import ArmKinematics, chain_of
from airhockey.envs.specs import RobotSpec

Array = NDArray[np.float64]


def pinocchio_model(spec: RobotSpec) -> tuple[pin.Model, int]:
    """A chain of joints about their own z axes, and the index of the rod tip's frame at its end."""
    model, chain, joint = pin.Model(), chain_of(spec), 0
    for number, (offset, rotation) in enumerate(zip(chain.offset, chain.rotation, strict=True), start=1):
        joint = model.addJoint(joint, pin.JointModelRZ(), pin.SE3(rotation, offset), f"joint_{number}")
    tip = pin.SE3.Identity()
    tip.translation = chain.tip
    return model, cast(int, model.addFrame(pin.Frame("ee", joint, 0, tip, pin.FrameType.OP_FRAME)))


class PinocchioKinematics(ArmKinematics):
    """Where the rod tip is and how fast each joint moves it, by Pinocchio; the rest is the compiled functions'."""

    def __init__(self, spec: RobotSpec) -> None:
        """Take the dimensions of a robot."""
        super().__init__(spec)
        self._model, self._tip = pinocchio_model(spec)
        self._data = self._model.createData()

    def position_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """Position and Jacobian of the rod tip, in [m] and [m]/[rad]. Shapes (3,), (3, n)."""
        frame = pin.LOCAL_WORLD_ALIGNED
        jacobian = pin.computeFrameJacobian(self._model, self._data, q, self._tip, frame)[:3]
        placement = pin.updateFramePlacement(self._model, self._data, self._tip)
        return np.array(placement.translation), np.array(jacobian)

    def rotation(self, q: Array) -> Array:
        """Rotation of the rod: its axes as columns, in the robot frame. Shape (3, 3)."""
        self.position_and_jacobian(q)
        return np.array(self._data.oMf[self._tip].rotation)
