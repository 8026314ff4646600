"""What every player is: the official agent interface, without MushroomRL.

An evaluator calls `episode_start()` when a serve begins and `draw_action(observation)` at every control step. A
subclass gives `reset()` and `draw_action()`. The class is duck-compatible with the challenge's own `AgentBase`, so
that a submission written for one runs on the other.
"""

import abc
import copy
from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.copying import Copyable

Array = NDArray[np.float64]


def task_of(env_info: Mapping[str, Any]) -> str:
    """What an agent is to do: "hit", "defend", "prepare" or "tournament", whatever its edition calls the environment.

    Names are `7dof-hit` (2023) or `hit` (2025); `hit_single` is the same task without an opponent.
    """
    return str(env_info["env_name"]).rpartition("-")[2].partition("_")[0]


class AgentBase(Copyable, abc.ABC):
    """A player that is given `env_info` once and an observation at every control step.

    A copy (`agent.copy()`, `copy`, `pickle`) plays on from here by itself, and the original is left as it is.

    Attributes:
        interpolation_order: The trajectory interpolation that this agent's actions are meant for (challenge's section
            2).
        env_info: The description of the environment, as handed in.
        agent_id: 1 for the robot on the left, 2 for the robot on the right. Both see the same picture.
        phase: Name of what the agent is doing, for logs and pictures.
        next_action: Kept for the official interface; always None.
    """

    interpolation_order: int | None = 3

    def __init__(self, env_info: Mapping[str, Any], agent_id: int = 1, **kwargs: Any) -> None:
        """Keep the description of the environment.

        Args:
            env_info: Keys as in the challenge's interface (`robot`, `puck_pos_ids`, …).
            agent_id: 1 or 2.
            kwargs: Ignored here; the keys of a submission's configuration that a subclass does not take.
        """
        self.env_info = env_info
        self.agent_id = agent_id
        self.phase = "start"
        self.next_action: None = None
        self._robot_model: Any = None
        self._robot_data: Any = None
        self._kinematics: Any = None

    @abc.abstractmethod
    def reset(self) -> None:
        """Forget the game so far: a new serve begins."""

    @abc.abstractmethod
    def draw_action(self, observation: Array) -> Array:
        """The next command.

        Args:
            observation: In the robot's own frame, as laid out by the `*_ids` of `env_info`. Shape (d,).

        Returns:
            Joint command for `interpolation_order`; for order 3 position [rad] and velocity [rad]/[s]. Shape (2, n).
        """

    def episode_start(self) -> None:
        """Called by the evaluator when a serve begins."""
        self.reset()

    def stop(self) -> None:
        """Called by the evaluator when an evaluation ends."""

    @property
    def preprocessors(self) -> list[Any]:
        """Functions that the official core applies to observations first: none."""
        return []

    @property
    def robot_model(self) -> Any:
        """This agent's own copy of the robot-only MuJoCo model, made when first asked for."""
        if self._robot_model is None:
            self._robot_model = copy.deepcopy(self.env_info["robot"]["robot_model"])
        return self._robot_model

    @property
    def robot_data(self) -> Any:
        """This agent's own copy of the robot-only MuJoCo data, made when first asked for."""
        if self._robot_data is None:
            self._robot_data = copy.deepcopy(self.env_info["robot"]["robot_data"])
        return self._robot_data

    def get_puck_state(self, obs: Array) -> tuple[Array, Array]:
        """Puck position (x, y, yaw) and velocity, in [m], [rad] and per [s]. Shapes (3,), (3,)."""
        return self.get_puck_pos(obs), self.get_puck_vel(obs)

    def get_puck_pos(self, obs: Array) -> Array:
        """Puck position (x, y, yaw) in the robot frame. Shape (3,)."""
        return np.asarray(obs[self.env_info["puck_pos_ids"]])

    def get_puck_vel(self, obs: Array) -> Array:
        """Puck velocity (x, y, yaw) in the robot frame. Shape (3,)."""
        return np.asarray(obs[self.env_info["puck_vel_ids"]])

    def get_joint_state(self, obs: Array) -> tuple[Array, Array]:
        """Joint positions [rad] and velocities [rad]/[s]. Shapes (n,), (n,)."""
        return self.get_joint_pos(obs), self.get_joint_vel(obs)

    def get_joint_pos(self, obs: Array) -> Array:
        """Joint positions, in [rad]. Shape (n,)."""
        return np.asarray(obs[self.env_info["joint_pos_ids"]])

    def get_joint_vel(self, obs: Array) -> Array:
        """Joint velocities, in [rad]/[s]. Shape (n,)."""
        return np.asarray(obs[self.env_info["joint_vel_ids"]])

    def get_ee_pose(self, obs: Array) -> tuple[Array, Array]:
        """This robot's own end-effector in its frame: position [m] and rotation matrix. Shapes (3,), (3, 3)."""
        if self._kinematics is None:
            from airhockey.agents.control.kinematics import ArmKinematics, spec_of

            self._kinematics = ArmKinematics(spec_of(self.env_info))
        joint_position = self.get_joint_pos(obs)
        return self._kinematics.position(joint_position), self._kinematics.rotation(joint_position)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()
