"""`AgentBase`: a MushroomRL agent without a policy."""

import copy
from pathlib import Path
from typing import Any, Self

import numpy as np
from mushroom_rl.core import Agent
from numpy.typing import NDArray

from airhockey.compat import bridges
from airhockey.compat.rl_info import mdp_info

from ..utils.kinematics import forward_kinematics

Array = NDArray[np.float64]

bridges.install()  # saved agents hold whole objects, which torch refuses by default since 2.6


class AgentBase(Agent):
    """What every agent of the challenge derives from; subclasses give `reset()` and `draw_action(observation)`.

    Attributes:
        env_info: The description of the environment.
        agent_id: 1 or 2.
        robot_model, robot_data: The agent's own copies of MuJoCo's model and data of the robot.
    """

    def __init__(self, env_info: dict[str, Any], agent_id: int = 1, **kwargs: Any) -> None:
        env_info["rl_info"] = mdp_info(env_info["rl_info"])
        super().__init__(env_info["rl_info"], None)
        self._add_save_attr(env_info="none", agent_id="none", robot_model="none", robot_data="none")
        self._settle(env_info, agent_id)

    def reset(self) -> None:
        """An episode begins."""
        raise NotImplementedError

    def draw_action(self, observation: Array) -> Any:
        """The next command."""
        raise NotImplementedError

    def episode_start(self) -> None:
        """Called by the evaluator when an episode begins."""
        self.reset()

    @classmethod
    def load_agent(cls, path: str | Path, env_info: dict[str, Any], agent_id: int = 1) -> Self:
        """An agent that was saved with `save(path)`."""
        agent = cls.load(path)
        env_info["rl_info"] = mdp_info(env_info["rl_info"])
        agent.mdp_info = env_info["rl_info"]
        agent._settle(env_info, agent_id)
        return agent  # type: ignore[no-any-return]

    def get_puck_state(self, obs: Array) -> tuple[Array, Array]:
        """Position and velocity of the puck, each (x, y, yaw)."""
        return self.get_puck_pos(obs), self.get_puck_vel(obs)

    def get_joint_state(self, obs: Array) -> tuple[Array, Array]:
        """Joint positions and velocities."""
        return self.get_joint_pos(obs), self.get_joint_vel(obs)

    def get_puck_pos(self, obs: Array) -> Array:
        """Position of the puck (x, y, yaw)."""
        return np.asarray(obs[self.env_info["puck_pos_ids"]])

    def get_puck_vel(self, obs: Array) -> Array:
        """Velocity of the puck (x, y, yaw)."""
        return np.asarray(obs[self.env_info["puck_vel_ids"]])

    def get_joint_pos(self, obs: Array) -> Array:
        """Joint positions."""
        return np.asarray(obs[self.env_info["joint_pos_ids"]])

    def get_joint_vel(self, obs: Array) -> Array:
        """Joint velocities."""
        return np.asarray(obs[self.env_info["joint_vel_ids"]])

    def get_ee_pose(self, obs: Array) -> tuple[Array, Array]:
        """Position and rotation matrix of the agent's own end-effector in the robot frame."""
        return forward_kinematics(self.robot_model, self.robot_data, self.get_joint_pos(obs))

    def _settle(self, env_info: dict[str, Any], agent_id: int) -> None:
        self.env_info, self.agent_id = env_info, agent_id
        self.robot_model = copy.deepcopy(env_info["robot"]["robot_model"])
        self.robot_data = copy.deepcopy(env_info["robot"]["robot_data"])
