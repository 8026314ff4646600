"""Dimensions, masses, gains and limits of the table, the puck and both robots: each number once, with its unit.

Source of every figure, unless a line says otherwise: the official package of the 2023 Robot Air Hockey Challenge (branches
warm-up, qualifying and tournament), read off its models and checked against its running simulation. Units are m, kg, rad,
s, N·m. The world frame has its origin at the table centre on its surface, x towards the right robot, z up. A quaternion is
(w, x, y, z). A robot's own frame ("robot frame") has its origin at the robot's base.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

TIMESTEP = 0.001
"""Length of one simulation step, in [s]."""
SUBSTEPS = 20
"""Simulation steps in one control step (50 Hz)."""
CONTROL_PERIOD = 0.02
"""Length of one control step, in [s]."""
X, Y, YAW, X_VELOCITY, Y_VELOCITY, YAW_RATE = range(6)
"""Where the puck's state stands in an observation, in [m, m, rad] and [m/s, m/s, rad/s]."""
JOINTS = 6
"""Where the joints' positions begin in an observation; their velocities come next, then the opponent's rod tip."""
POSITION, VELOCITY, ACCELERATION = range(3)
"""Rows of an action, of a command and of a set-point, in [rad], [rad/s] and [rad/s²]."""
SOFT_LIMIT = 0.95
"""Share of a joint's position or velocity limit beyond which the constraints count a violation."""


@dataclass(frozen=True)
class Table:
    """Playing area, measured between the inner edges of the rims, in [m]."""

    length: float = 1.948
    width: float = 1.038
    goal_width: float = 0.25


@dataclass(frozen=True)
class Puck:
    """A cylinder that slides on the table; its friction is the damping of its three joints."""

    radius: float = 0.03165
    half_height: float = 0.01
    mass: float = 0.01
    inertia: Vector = (2.5e-6, 2.5e-6, 5e-6)
    slide_damping: float = 0.005  # [N·s/m]
    yaw_damping: float = 2e-6  # [N·m·s/rad]


@dataclass(frozen=True)
class Mallet:
    """The disc at the end of an arm that plays the puck."""

    radius: float = 0.04815


@dataclass(frozen=True)
class Link:
    """A body that turns about its own z axis in its parent's frame.

    Attributes:
        position, quaternion: Pose in the parent's frame at joint angle zero.
        center_of_mass: In the link's frame, in [m].
        inertia: xx, yy, zz, xy, xz, yz about the centre of mass, in [kg·m²].
        damping: Viscous friction of the joint, in [N·m·s/rad].
        friction_loss: Dry friction of the joint, in [N·m].
        armature: Rotor inertia, in [kg·m²].
        position_limit: Half of the symmetric joint range, in [rad].
        velocity_limit: In [rad/s].
        acceleration_limit: In [rad/s²].
        torque_limit: In [N·m].
        stiffness, viscosity: Gains K_p in [N·m/rad] and K_d in [N·m·s/rad] of the joint controller.
    """

    position: Vector
    quaternion: Quaternion
    mass: float
    center_of_mass: Vector
    inertia: tuple[float, float, float, float, float, float]
    position_limit: float
    velocity_limit: float
    acceleration_limit: float
    torque_limit: float
    stiffness: float
    viscosity: float
    damping: float = 0.0
    friction_loss: float = 0.0
    armature: float = 0.0


@dataclass(frozen=True)
class FixedBody:
    """A body welded to its parent."""

    name: str
    position: Vector
    mass: float
    inertia: Vector


@dataclass(frozen=True)
class RobotSpec:
    """An arm: a chain of links, the welded bodies that end in the end-effector frame, and where the arm stands.

    Attributes:
        prefix: First part of every name in the model, completed by the robot's number: ``iiwa_1``.
        link_prefix: First part of a link's name: ``link_1``.
        end_effector: The name of the body whose frame is the end-effector frame.
        tip: Bodies welded one after the other to the last link.
        start: Joint positions at the beginning of an episode, in [rad].
        desired_height: Height of the end-effector frame in the robot frame during play, in [m].
        base_positions: World positions of the bases of robot 1 and robot 2 (which is turned by 180° about z), in [m].
    """

    prefix: str
    link_prefix: str
    links: tuple[Link, ...]
    tip: tuple[FixedBody, ...]
    end_effector: str
    start: tuple[float, ...]
    desired_height: float
    base_positions: tuple[Vector, ...]
    universal_height: float | None = None

    @property
    def n_joints(self) -> int:
        """Number of actuated joints n."""
        return len(self.links)

    @cached_property
    def joint_position_limit(self) -> NDArray[np.float64]:
        """Lower and upper joint limits, in [rad]. Shape (2, n)."""
        return _symmetric([link.position_limit for link in self.links])

    @cached_property
    def joint_velocity_limit(self) -> NDArray[np.float64]:
        """Lower and upper velocity limits, in [rad/s]. Shape (2, n)."""
        return _symmetric([link.velocity_limit for link in self.links])

    @cached_property
    def joint_acceleration_limit(self) -> NDArray[np.float64]:
        """Lower and upper acceleration limits, in [rad/s²]. Shape (2, n)."""
        return _symmetric([link.acceleration_limit for link in self.links])

    @cached_property
    def base_frames(self) -> tuple[NDArray[np.float64], ...]:
        """Homogeneous transforms from each robot frame to the world. Each of shape (4, 4)."""
        frames = []
        for side, position in zip((1.0, -1.0), self.base_positions, strict=False):
            frame = np.diag([side, side, 1.0, 1.0])
            frame[:3, 3] = position
            frames.append(frame)
        return tuple(frames)


def _symmetric(limit: list[float]) -> NDArray[np.float64]:
    limits = np.array([limit, limit])
    limits[0] *= -1.0
    limits.setflags(write=False)
    return limits


TABLE = Table()
PUCK = Puck()
MALLET = Mallet()

JOINT_VELOCITY_FILTER = 0.274
"""Share of the newest joint velocity in the exponential filter that controller and observations see."""


Body = tuple[float, Vector, tuple[float, float, float, float, float, float]]
"""Mass, centre of mass, inertia; see `Link`."""
Gains = tuple[float, float]
"""Stiffness and viscosity."""


def _planar_link(offset: Vector, body: Body, limits: Vector, gains: Gains) -> Link:
    """A link of the planar arm. `limits`: [rad], [rad/s] and [N·m]."""
    position_limit, velocity_limit, torque_limit = limits
    return Link(
        position=offset,
        quaternion=(1.0, 0.0, 0.0, 0.0),
        mass=body[0],
        center_of_mass=body[1],
        inertia=body[2],
        position_limit=position_limit,
        velocity_limit=velocity_limit,
        acceleration_limit=4.0 * velocity_limit,
        torque_limit=torque_limit,
        stiffness=gains[0],
        viscosity=gains[1],
    )


_ROD = (2.0, (0.2, 0.0, 0.0), (0.0335, 0.0335, 0.003, 0.0, 0.0, 0.0))
PLANAR = RobotSpec(
    prefix="planar_robot",
    link_prefix="body",
    links=(
        _planar_link(
            (0, 0, 0.25),
            (3.0, (0.25, 0.0, 0.0), (0.064375, 0.064375, 0.00375, 0.0, 0.0, 0.0)),
            (2.9670597283903604, math.pi / 2, 100.0),
            (960.0, 60.0),
        ),
        _planar_link((0.55, 0, 0), _ROD, (1.8, math.pi / 2, 50.0), (480.0, 20.0)),
        _planar_link((0.44, 0, 0), _ROD, (2.0943951023931953, 2 * math.pi / 3, 30.0), (240.0, 4.0)),
    ),
    tip=(
        FixedBody("body_hand", (0.44, 0.0, 0.0), 0.1, (0.0008, 0.0023, 0.0023)),
        FixedBody("body_ee", (0.0, 0.0, -0.15), 0.1, (0.0008, 0.0023, 0.0023)),
    ),
    end_effector="body_ee",
    start=(-1.15570723, 1.30024401, 1.44280414),
    desired_height=0.1,
    base_positions=((-1.51, 0.0, -0.1),),
)


def _iiwa_link(
    pose: tuple[Vector, Quaternion],
    body: Body,
    friction: tuple[float, float],
    limits: Vector,
    gains: Gains,
    armature: float = 0.0,
) -> Link:
    """A link of the iiwa. `friction`: damping and dry friction; `limits`: [rad], [°/s] and [N·m]."""
    position_limit, velocity_limit, torque_limit = limits
    return Link(
        position=pose[0],
        quaternion=pose[1],
        mass=body[0],
        center_of_mass=body[1],
        inertia=body[2],
        position_limit=position_limit,
        velocity_limit=math.radians(velocity_limit),
        acceleration_limit=math.radians(10.0 * velocity_limit),
        torque_limit=torque_limit,
        stiffness=gains[0],
        viscosity=gains[1],
        damping=friction[0],
        friction_loss=friction[1],
        armature=armature,
    )


_UPRIGHT = (1.0, 0.0, 0.0, 0.0)
_TO_Y = (0.0, 0.0, 0.707107, 0.707107)
_ABOUT_X = (0.707107, 0.707107, 0.0, 0.0)
IIWA = RobotSpec(
    prefix="iiwa",
    link_prefix="link",
    links=(
        _iiwa_link(
            ((0, 0, 0.1575), _UPRIGHT),
            (
                8.240527,
                (4.007709e-06, -0.033936, 0.122467),
                (0.021981, 0.022182, 0.008234, -2.897243e-07, 6.3165236e-07, 0.003285),
            ),
            (0.33032, 0.384477),
            (2.96706, 85.0, 320.0),
            (1500.0, 60.0),
        ),
        _iiwa_link(
            ((0, 0, 0.2025), _TO_Y),
            (
                6.357896,
                (0.003402, 0.034792, 0.046725),
                (0.015565, 0.005180, 0.015484, -4.147301e-06, 1.192255e-05, 0.002538),
            ),
            (0.21216, 0.496333),
            (2.0944, 85.0, 320.0),
            (1500.0, 80.0),
        ),
        _iiwa_link(
            ((0, 0.2045, 0), _TO_Y),
            (
                4.042756,
                (-0.001452, 0.031526, 0.133584),
                (0.010914, 0.010381, 0.003139, -3.540575e-06, -9.059062e-06, -0.002128),
            ),
            (0.1, 0.173951),
            (2.96706, 100.0, 176.0),
            (1200.0, 60.0),
        ),
        _iiwa_link(
            ((0, 0, 0.2155), _ABOUT_X),
            (
                3.642249,
                (-0.002527, 0.053508, 0.037205),
                (0.007536, 0.002538, 0.007206, -5.707028e-06, 2.781894e-06, 0.001256),
            ),
            (0.219041, 0.3751),
            (2.0944, 75.0, 176.0),
            (1200.0, 30.0),
        ),
        _iiwa_link(
            ((0, 0.1845, 0), _TO_Y),
            (
                2.580896,
                (0.001855, 0.024573, 0.080131),
                (0.005201, 0.004488, 0.002242, 1.089316e-07, 9.035623e-07, -0.001613),
            ),
            (0.185923, 0.481099),
            (2.96706, 130.0, 110.0),
            (1000.0, 10.0),
        ),
        _iiwa_link(
            ((0, 0, 0.2155), _ABOUT_X),
            (
                2.760564,
                (-0.001739, -0.001973, -0.002502),
                (0.002534, 0.001821, 0.002393, -1.311766e-06, 9.508242e-07, 0.000134),
            ),
            (0.1, 0.196149),
            (2.0944, 135.0, 40.0),
            (1000.0, 1.0),
        ),
        _iiwa_link(
            ((0, 0.081, 0), _TO_Y),
            (
                1.285417,
                (0.000735, 0.000387, 0.026460),
                (0.000151, 0.000150, 0.000187, -7.223100e-08, 2.038333e-06, -3.396830e-07),
            ),
            (0.1, 0.299238),
            (3.05433, 135.0, 40.0),
            (500.0, 0.5),
            armature=0.01,
        ),
    ),
    tip=(FixedBody("striker_joint_link", (0.0, 0.0, 0.585), 0.1, (0.001, 0.001, 0.001)),),
    end_effector="striker_joint_link",
    start=(0.0, -0.19606734516266716, 0.0, -1.8436389808766431, 0.0, 0.9704222379486207, 0.0),
    desired_height=0.1645,
    base_positions=((-1.51, 0.0, -0.1), (1.51, 0.0, -0.1)),
    universal_height=0.0645,
)


@dataclass(frozen=True)
class Striker:
    """The iiwa's mallet on its universal joint (two hinges: about y, then about x), driven to stay level."""

    mass: float = 0.283
    center_of_mass: Vector = (0.0, 0.0, 0.0682827)
    inertia: float = 0.005
    range: float = 1.5708
    torque_limit: float = 10.0
    stiffness: float = 4.0  # [N·m/rad]
    viscosity: float = 0.31  # [N·m·s/rad]
    filter: float = 0.273  # share of the newest velocity in the exponential filter of its damping term
    soft_range: float = 0.95 * math.pi / 2  # the desired angles stay within, in [rad]


STRIKER = Striker()
