"""What keeps the iiwa's mallet level: a controller of the two joints between rod and mallet."""

import copy
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.specs import STRIKER

from .kinematics import forward_kinematics

Array = NDArray[np.float64]


class UniversalJointPlugin:
    """Sets the torques of the universal joints in MuJoCo's data; call `update` before every simulation step.

    Args:
        env_model, env_data: Of the scene.
        env_info: Its description; the robot-only model in it gives the rod's direction.
    """

    def __init__(self, env_model: Any, env_data: Any, env_info: dict[str, Any], **kwargs: Any) -> None:
        self.env_info, self.env_model, self.env_data = env_info, env_model, env_data
        self._robots = [_Robot(env_model, number + 1) for number in range(env_info["n_agents"])]
        self.reset()

    def bound_to(self, env_model: Any, env_data: Any, env_info: Any) -> "UniversalJointPlugin":
        """The same moment of this controller, of another scene's data."""
        twin = copy.copy(self)
        twin.env_info, twin.env_model, twin.env_data = env_info, env_model, env_data
        twin._average = self._average.copy()
        return twin

    def reset(self) -> None:
        """Put the mallets level, and forget what was before."""
        self._average = np.zeros((len(self._robots), 2))
        self._seen: Array | None = None
        for robot in self._robots:
            self.env_data.qpos[robot.striker] = self._desired(robot)

    def update(self) -> None:
        """The torques of this simulation step."""
        seen = self.env_data.qpos[self._robots[0].striker].copy()
        for average, robot in zip(self._average, self._robots, strict=True):
            average += STRIKER.filter * (self.env_data.qvel[robot.striker_velocity] - average)
            error = self._desired(robot) - self.env_data.qpos[robot.striker]
            self.env_data.ctrl[robot.motors] = STRIKER.stiffness * error - STRIKER.viscosity * average
        self._seen = seen

    def _desired(self, robot: "_Robot") -> Array:
        """Angles that level the mallet, near where it was (robot 2's are compared with robot 1's, as officially)."""
        info = self.env_info["robot"]
        _, rotation = forward_kinematics(info["robot_model"], info["robot_data"], self.env_data.qpos[robot.joints])
        angles = level_angles(rotation[:, 0], rotation[:, 1])
        if self._seen is not None:
            angles -= 2.0 * np.pi * np.round((angles - self._seen) / (2.0 * np.pi))
        return np.clip(angles, -STRIKER.soft_range, STRIKER.soft_range)


class _Robot:
    """Where one robot's joints stand in MuJoCo's arrays."""

    def __init__(self, model: Any, number: int) -> None:
        name = f"iiwa_{number}"
        self.joints = [int(model.joint(f"{name}/joint_{k}").qposadr[0]) for k in range(1, 8)]
        strikers = [model.joint(f"{name}/striker_joint_{k}") for k in (1, 2)]
        self.striker = [int(joint.qposadr[0]) for joint in strikers]
        self.striker_velocity = [int(joint.dofadr[0]) for joint in strikers]
        self.motors = [model.actuator(f"{name}/striker_joint_{k}").id for k in (1, 2)]


def level_angles(x: Array, y: Array) -> Array:
    """The two joints' angles that level a mallet on a rod with these axes (challenge page, section 2). Shape (2,).

    The square of the cross-product matrix is element-wise: an official slip, kept.
    """
    wanted = np.array([-y[1], y[0], 0.0])
    first = np.arctan2(np.cross(x, wanted) @ y, x @ wanted)
    cross = np.array([[0.0, -y[2], y[1]], [y[2], 0.0, -y[0]], [-y[1], y[0], 0.0]])
    turned = (np.eye(3) + cross * np.sin(first) + cross * cross * (1.0 - np.cos(first))) @ x
    wanted = np.array([turned[1], -turned[0], 0.0])
    return np.array([first, np.arctan2(np.cross(y, wanted) @ turned, y @ wanted)])
