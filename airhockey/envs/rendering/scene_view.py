"""A MuJoCo scene in which puck and arms are put where they were, without physics."""

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from airhockey.envs import scene
from airhockey.envs.editions import DEFAULT, ROBOTS, edition

Array = NDArray[np.float64]
STRIKER_JOINTS = 2


class SceneView:
    """The scene of an environment with its arms drawn.

    Args:
        env: Name of an environment.
        edition_name: The year whose rules apply.

    Attributes:
        model, data: MuJoCo's.
        robots: Number of arms.
        n_joints: Of each arm.
    """

    def __init__(self, env: str, edition_name: str = DEFAULT) -> None:
        year = edition(edition_name)
        rules = year.environment(env)
        self.robot = ROBOTS[rules.robot]
        self.robots, self.n_joints = rules.robots, self.robot.n_joints
        self.model = scene.game_model(self.robot, self.robots, visual=True, edition_scene=year.scene)
        self.data = mujoco.MjData(self.model)
        self._has_striker = self.robot.universal_height is not None
        self._stride = self.n_joints + (STRIKER_JOINTS if self._has_striker else 0)
        self._tips = [
            self.model.body(f"{self.robot.prefix}_{number}/{self.robot.end_effector}").id
            for number in range(1, self.robots + 1)
        ]

    def show(self, puck: Array, joints: Array) -> None:
        """Put everything in its place; the mallets lie flat, as the universal joint keeps them.

        Args:
            puck: x, y in [m] and yaw in [rad], in the world. Shape (3,).
            joints: Joint positions, in [rad]. Shape (robots, n).
        """
        data = self.data
        data.qpos[-3:] = puck
        data.qvel[:] = 0.0
        for r, position in enumerate(joints):
            data.qpos[r * self._stride : r * self._stride + self.n_joints] = position
        mujoco.mj_kinematics(self.model, data)
        if self._has_striker:
            for r, tip in enumerate(self._tips):
                first = r * self._stride + self.n_joints
                data.qpos[first : first + STRIKER_JOINTS] = level_striker(data.xmat[tip].reshape(3, 3))
        mujoco.mj_forward(self.model, data)

    def copy_state(self, source: Any) -> None:
        """Show what a simulation of the same scene shows: its `MjData`, drawn arms or not."""
        self.place(source.qpos, source.qvel, source.time)

    def place(self, position: Array, velocity: Array, time: float) -> None:
        """Show a moment by MuJoCo's `qpos` and `qvel`, at a time in [s]."""
        self.data.qpos[:], self.data.qvel[:], self.data.time = position, velocity, time
        mujoco.mj_forward(self.model, self.data)

    def tip_position(self, r: int, joint_position: Array) -> Array:
        """Where the end-effector of arm r would be with these joints, in the world. The scene itself is left as it is.

        Args:
            r: 0 or 1.
            joint_position: In [rad]. Shape (n,).

        Returns:
            In [m]. Shape (3,).
        """
        ghost = self._ghost
        ghost.qpos[r * self._stride : r * self._stride + self.n_joints] = joint_position
        mujoco.mj_kinematics(self.model, ghost)
        return np.array(ghost.xpos[self._tips[r]])

    def follow_tips(self, r: int, tips: Array) -> Array:
        """Joint positions with which arm r's end-effector goes along a path, starting at its start configuration.

        Damped least squares on the position, step by step, as the challenge's moving opponent finds its joints; of an
        arm of which only the tip was recorded this is a likely picture, not a measurement.

        Args:
            r: 0 or 1.
            tips: Positions in the world, in [m]. Shape (T, 3).

        Returns:
            Shape (T, n).
        """
        joints = np.array(self.robot.start)
        path = np.empty((len(tips), self.n_joints))
        columns = slice(r * self._stride, r * self._stride + self.n_joints)
        jacobian = np.empty((3, self.model.nv))
        for t, target in enumerate(tips):
            for _ in range(50 if t == 0 else 8):
                error = target - self.tip_position(r, joints)
                if np.linalg.norm(error) < 1e-4:
                    break
                mujoco.mj_comPos(self.model, self._ghost)
                mujoco.mj_jacBody(self.model, self._ghost, jacobian, None, self._tips[r])
                j = jacobian[:, columns]
                joints = joints + np.linalg.solve(j.T @ j + 1e-3 * np.eye(self.n_joints), j.T @ error)
            path[t] = joints
        return path

    @property
    def _ghost(self) -> Any:
        """A second state of the scene, for questions."""
        if not hasattr(self, "_ghost_data"):
            self._ghost_data = mujoco.MjData(self.model)
        return self._ghost_data


def level_striker(tip: Array) -> tuple[float, float]:
    """Angles of the universal joint with which the mallet lies flat on the table.

    The mallet hangs along +z of its frame. With the rotations a about y and then b about x, its axis in the tip's frame is
    (sin a cos b, -sin b, cos a cos b); that is to be straight down in the world.

    Args:
        tip: Orientation of the end-effector. Shape (3, 3).

    Returns:
        a and b, in [rad].
    """
    down = -tip[2]
    return float(np.arctan2(down[0], down[2])), float(-np.arcsin(np.clip(down[1], -1.0, 1.0)))
