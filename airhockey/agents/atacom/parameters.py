"""What can be tuned about ATACOM: `iiwa.yaml` and `planar.yaml` beside this module."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from airhockey.agents.parameters import load_parameters
from airhockey.envs.specs import RobotSpec


@dataclass(frozen=True)
class AtacomParameters:
    """Margins, softness and gains.

    Attributes:
        acceleration_share, velocity_share, position_share: Of the joints' limits; the challenge counts velocities and
            positions beyond 0.95.
        edge_margin: Between the commanded rod tip and where `ee_constr` begins, in [m]: room for the tracking error.
        height_tolerance: Of the commanded rod tip about its desired height, in [m]; `ee_constr` allows 0.02.
        link_height: Least commanded height of elbow and wrist, in [m]; `link_constr` begins at 0.25.
        edge_time, height_time, link_time, joint_time: K_f of the viability form k + K_f k̇ ≤ 0, in [s]: how long a limit
            takes to be approached by the factor e.
        edge_softness, height_softness, link_softness, joint_softness: 1/β: slack at which a limit begins to be felt, in
            [m] and [rad].
        velocity_softness: The same for joint velocities, as a share of their limits.
        contraction: λ, in [1/s].
        tip_acceleration: Largest acceleration that the tip's policy may ask for, in [m]/[s²].
        tip_speed: The tip's speed at an action of 1, in [m]/[s].
        follow_time: Time constant with which tip and joints take up the speed asked for, in [s].
        joint_speed: A joint's speed at an action of 1, as a share of its limit: all seven together are much faster.
        height_gain: Stiffness of the pull to the desired height, in [1/s²]; critically damped.
        posture_gain: Stiffness of the null space's pull to the start posture, in [1/s²]; critically damped.
        substeps: Into which a control step is divided.
    """

    acceleration_share: float
    velocity_share: float
    position_share: float
    edge_margin: float
    height_tolerance: float
    link_height: float
    edge_time: float
    height_time: float
    link_time: float
    joint_time: float
    edge_softness: float
    height_softness: float
    link_softness: float
    joint_softness: float
    velocity_softness: float
    contraction: float
    tip_acceleration: float
    tip_speed: float
    follow_time: float
    joint_speed: float
    height_gain: float
    posture_gain: float
    substeps: int


@cache
def atacom_parameters(spec: RobotSpec) -> AtacomParameters:
    """The package's parameters for a robot."""
    return load_parameters(AtacomParameters, "iiwa" if spec.n_joints == 7 else "planar", Path(__file__).parent)
