"""The arm as arrays that compiled code can use, read off the compiled robot-only model."""

from typing import Any, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from airhockey.envs.specs import RobotSpec

Array = NDArray[np.float64]


class Arm(NamedTuple):
    """A serial chain of n links that all turn about their own z axis; bodies welded to a link are merged into it.

    Attributes:
        offset: Position of each link's origin in its parent's frame, in [m]. Shape (n, 3).
        rotation: Orientation in the parent's frame at joint angle zero. Shape (n, 3, 3).
        mass: In [kg]. Shape (n,).
        center_of_mass: In the link's frame, in [m]. Shape (n, 3).
        inertia: About the centre of mass, in the link's axes, in [kg·m²]. Shape (n, 3, 3).
        armature: Rotor inertia, in [kg·m²]. Shape (n,).
        tip: Origin of the end-effector frame in the last link's frame, in [m]. Shape (3,).
        stiffness, viscosity, torque_limit: Of the joint controller, in [N·m/rad], [N·m·s/rad], [N·m]. Each of shape (n,).
        position_limit, velocity_limit: Lower and upper, in [rad] and [rad/s]. Each of shape (2, n).
        desired_height: Of the end-effector in the robot frame, in [m].
        universal_joint: Whether the mallet hangs on a universal joint.
    """

    offset: Array
    rotation: Array
    mass: Array
    center_of_mass: Array
    inertia: Array
    armature: Array
    tip: Array
    stiffness: Array
    viscosity: Array
    torque_limit: Array
    position_limit: Array
    velocity_limit: Array
    desired_height: float
    universal_joint: bool


def arm_from_model(robot: RobotSpec, model: mujoco.MjModel) -> Arm:
    """Collect the chain of `robot` from its compiled robot-only model."""
    n = robot.n_joints
    bodies = [model.body(f"{robot.prefix}_1/{robot.link_prefix}_{index}").id for index in range(1, n + 1)]
    tip = np.zeros(3)
    composite = [_Rigid.of(model, body) for body in bodies]
    for fixed in robot.tip:
        body = model.body(f"{robot.prefix}_1/{fixed.name}").id
        tip = tip + model.body_pos[body]  # the welded bodies are not turned
        composite[-1] = composite[-1].merged(_Rigid.of(model, body).moved(tip))
    return Arm(
        offset=_rows(model.body_pos[bodies]),
        rotation=_rows(np.array([_matrix(model.body_quat[body]) for body in bodies])),
        mass=np.array([rigid.mass for rigid in composite]),
        center_of_mass=np.array([rigid.center for rigid in composite]),
        inertia=np.array([rigid.inertia for rigid in composite]),
        armature=_rows(model.dof_armature[:n]),
        tip=tip,
        stiffness=np.array([link.stiffness for link in robot.links]),
        viscosity=np.array([link.viscosity for link in robot.links]),
        torque_limit=np.array([link.torque_limit for link in robot.links]),
        position_limit=robot.joint_position_limit.copy(),
        velocity_limit=robot.joint_velocity_limit.copy(),
        desired_height=robot.desired_height,
        universal_joint=robot.universal_height is not None,
    )


class _Rigid(NamedTuple):
    """A rigid body: mass, centre of mass, inertia about it."""

    mass: float
    center: Array
    inertia: Array

    @classmethod
    def of(cls, model: mujoco.MjModel, body: int) -> "_Rigid":
        axes = _matrix(model.body_iquat[body])
        inertia = axes @ np.diag(model.body_inertia[body]) @ axes.T
        return cls(float(model.body_mass[body]), model.body_ipos[body].copy(), inertia)

    def moved(self, offset: Array) -> "_Rigid":
        return self._replace(center=self.center + offset)

    def merged(self, other: "_Rigid") -> "_Rigid":
        mass = self.mass + other.mass
        center = (self.mass * self.center + other.mass * other.center) / mass
        inertia = sum(part.inertia + part.mass * _steiner(part.center - center) for part in (self, other))
        return _Rigid(mass, center, np.asarray(inertia))


def _steiner(arm: Array) -> Array:
    return np.asarray(np.dot(arm, arm) * np.eye(3) - np.outer(arm, arm))


def _matrix(quaternion: Any) -> Array:
    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, quaternion)
    return matrix.reshape(3, 3)


def _rows(values: Any) -> Array:
    return np.ascontiguousarray(values, dtype=np.float64)
