"""Forward kinematics and Jacobians of both robots, in the robot's own frame.

The chain of links is that of `airhockey.envs.specs`, and the compiled functions are those of the simulator's own controller.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.compiling import compiled
from airhockey.envs.compiled import SerialChain, forward_kinematics, point_jacobian
from airhockey.envs.specs import IIWA, PLANAR, RobotSpec

Array = NDArray[np.float64]

ELBOW_LINK, WRIST_LINK = 4, 7
"""Links of the iiwa whose origins must stay above a height (challenge's section 5)."""


class Chain(NamedTuple):
    """Links that turn about their own z axes. See `airhockey.envs.compiled.SerialChain`."""

    offset: Array
    rotation: Array
    tip: Array


def spec_of(env_info: Mapping[str, Any]) -> RobotSpec:
    """The robot that `env_info` describes."""
    return IIWA if env_info["robot"]["n_joints"] == IIWA.n_joints else PLANAR


@cache
def chain_of(spec: RobotSpec) -> Chain:
    """A robot's links, and the rod at their end."""
    return Chain(
        np.array([link.position for link in spec.links], dtype=float),
        np.array([_matrix(link.quaternion) for link in spec.links]),
        np.sum([body.position for body in spec.tip], axis=0, dtype=float),
    )


class ArmKinematics:
    """Where the rod tip is, and how fast each joint moves it.

    Attributes:
        spec: Dimensions and limits of the robot.
        chain: Its links.
        n_joints: n.
        n_coordinates: How many coordinates of the rod tip the joints move: 3, or 2 on the planar robot, whose height
            is fixed.
        has_link_heights: Whether elbow and wrist heights are limited (iiwa).
    """

    def __init__(self, spec: RobotSpec) -> None:
        """Take the dimensions of a robot."""
        self.spec, self.chain = spec, chain_of(spec)
        self.n_joints = spec.n_joints
        self.has_link_heights = spec.n_joints >= WRIST_LINK
        self.n_coordinates = 3 if self.has_link_heights else 2

    def position(self, q: Array) -> Array:
        """Position of the rod tip, in [m].

        Args:
            q: Joint positions, in [rad]. Shape (n,).

        Returns:
            Coordinates in the robot frame. Shape (3,).
        """
        return self.position_and_jacobian(q)[0]

    def jacobian(self, q: Array) -> Array:
        """Position Jacobian of the rod tip, in [m]/[rad]. Shape (3, n)."""
        return self.position_and_jacobian(q)[1]

    def position_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """Both of the above. Shapes (3,), (3, n)."""
        position, jacobian = tip_and_jacobian(self.chain, q)
        return position, jacobian

    def rotation(self, q: Array) -> Array:
        """Rotation of the rod: its axes as columns, in the robot frame. Shape (3, 3)."""
        _, axes = locate(self.chain, q)
        return np.stack([axes[-2], axes[-1], axes[-3]], axis=1)

    def link_heights(self, q: Array) -> Array:
        """Heights of elbow and wrist above the robot's base, in [m]; empty on the planar robot. Shape (2,) or (0,)."""
        return self.link_heights_and_jacobian(q)[0]

    def link_heights_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """Heights of elbow and wrist, and how the joints move them. Shapes (2,), (2, n), or (0,), (0, n)."""
        heights, rows = heights_and_jacobian(*locate(self.chain, q))
        return heights, rows


@compiled
def locate(chain: SerialChain, q: Array) -> tuple[Array, Array]:
    """Positions of the links and the tip, and axes, as of `forward_kinematics`. Shapes (n + 1, 3), (n + 2, 3)."""
    n = len(q)
    positions, axes = np.empty((n + 1, 3)), np.empty((n + 2, 3))
    forward_kinematics(chain, q, positions, axes)
    return positions, axes


@compiled
def tip_and_jacobian(chain: Chain, q: Array) -> tuple[Array, Array]:
    """Position of the rod tip, and its Jacobian. Shapes (3,), (3, n)."""
    positions, axes = locate(chain, q)
    return positions[-1], jacobian_of(positions, axes, len(q))


@compiled
def jacobian_of(positions: Array, axes: Array, point: int) -> Array:
    """Jacobian of a link's origin, or of the tip (n), from what `locate` gave. Shape (3, n)."""
    jacobian = np.empty((3, len(positions) - 1))
    point_jacobian(positions, axes, point, jacobian)
    return jacobian


@compiled
def heights_and_jacobian(positions: Array, axes: Array) -> tuple[Array, Array]:
    """Heights of elbow and wrist, and their Jacobian, from what `locate` gave. Shapes (2,), (2, n), or (0,), (0, n)."""
    n = len(positions) - 1
    count = 2 if n >= WRIST_LINK else 0
    heights, rows = np.empty(count), np.empty((count, n))
    for i in range(count):
        link = (ELBOW_LINK if i == 0 else WRIST_LINK) - 1
        heights[i], rows[i] = positions[link, 2], jacobian_of(positions, axes, link)[2]
    return heights, rows


def _matrix(quaternion: tuple[float, float, float, float]) -> Array:
    """Rotation matrix of a quaternion (w, x, y, z) of any length. Shape (3, 3)."""
    w, x, y, z = np.asarray(quaternion) / np.linalg.norm(quaternion)
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )
