"""What can be tuned about the low-level controller: `iiwa.yaml` and `planar.yaml` beside this module."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from airhockey.agents.parameters import convert, load_parameters
from airhockey.agents.settings import asked_of, plain, with_settings
from airhockey.envs.specs import RobotSpec


@dataclass(frozen=True)
class ControlParameters:
    """Margins and weights of the joint controller.

    Attributes:
        solver: "dual", "daqp" or "osqp"; the last two need the extra `control`.
        kinematics: "compiled", or "pinocchio" (extra `control`).
        velocity_share, position_share: Of the joints' limits; the constraints count a violation beyond 0.95.
        acceleration_share: Of the joints' acceleration limits.
        anchor: Comfortable posture that the null space is drawn to, in [rad]. n values.
        anchor_gain: Speed of that pull, in [1/s].
        anchor_weights: Diagonal of the metric W. n values.
        tracking_weight: How much more an error of the tip's velocity counts than one of the anchor, where AQP is
            infeasible.
        sideways_weight: How much more its component across the asked direction counts than the one along it.
        height_weight: How much more its vertical component counts.
        position_gain: Share of a position error that one step removes.
        tip_acceleration: Of the rod tip when it keeps clear of the table's edges, in [m]/[s²].
        edge_margin: Between the commanded rod tip and where `ee_constr` begins, in [m].
        link_height: Least height of elbow and wrist, in [m]; the constraint begins at 0.25.
        link_height_gain: Share of the remaining height that one second may use up, in [1/s].
    """

    solver: str
    kinematics: str
    velocity_share: float
    position_share: float
    acceleration_share: float
    anchor: tuple[float, ...]
    anchor_gain: float
    anchor_weights: tuple[float, ...]
    tracking_weight: float
    sideways_weight: float
    height_weight: float
    position_gain: float
    tip_acceleration: float
    edge_margin: float
    link_height: float
    link_height_gain: float


def control_parameters(spec: RobotSpec) -> ControlParameters:
    """The package's parameters for a robot, with what `--set control.…` changes about them."""
    own, asked = _own_parameters(spec), asked_of("control")
    return convert(ControlParameters, with_settings(plain(own), asked), "--set control") if asked else own


@cache
def _own_parameters(spec: RobotSpec) -> ControlParameters:
    name = "iiwa" if spec.n_joints == 7 else "planar"
    return load_parameters(ControlParameters, name, Path(__file__).parent)
