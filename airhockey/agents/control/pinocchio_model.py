"""The arm as a Pinocchio model, for agents that want more of it than `kinematics` gives: dynamics, derivatives, optimisation.

It is built in code from `airhockey.envs.specs`: the same chain of links that the simulator compiles, without masses.
"""

from typing import cast

import pinocchio as pin

from airhockey.agents.control.kinematics import chain_of
from airhockey.envs.specs import RobotSpec


def pinocchio_model(spec: RobotSpec) -> tuple[pin.Model, int]:
    """A chain of joints about their own z axes, and the index of the rod tip's frame at its end."""
    model, chain, joint = pin.Model(), chain_of(spec), 0
    for number, (offset, rotation) in enumerate(zip(chain.offset, chain.rotation, strict=True), start=1):
        joint = model.addJoint(joint, pin.JointModelRZ(), pin.SE3(rotation, offset), f"joint_{number}")
    tip = pin.SE3.Identity()
    tip.translation = chain.tip
    return model, cast(int, model.addFrame(pin.Frame("ee", joint, 0, tip, pin.FrameType.OP_FRAME)))
