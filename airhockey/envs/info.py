"""`env_info`: what an agent is told about the environment (keys of the official package), and its spaces."""

import copy
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.constraints import challenge_constraints
from airhockey.envs.editions import Edition
from airhockey.envs.simulation import Simulation
from airhockey.envs.specs import CONTROL_PERIOD, MALLET, PUCK, TABLE, RobotSpec

Array = NDArray[np.float64]


@dataclass
class Box:
    """An interval of arrays, with the attributes of a MushroomRL box."""

    low: Array
    high: Array

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of an element."""
        return self.low.shape


@dataclass
class RLInfo:
    """Spaces, discount and horizon, with the attributes of MushroomRL's `MDPInfo`."""

    observation_space: Box
    action_space: Box
    gamma: float
    horizon: int
    dt: float

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of an observation, then that of an action."""
        return self.observation_space.shape + self.action_space.shape

    def copy(self) -> "RLInfo":
        """A copy that shares nothing."""
        return copy.deepcopy(self)


def observation_box(robot: RobotSpec, n_robots: int) -> Box:
    """Bounds of one player's observation in the robot frame."""
    low = [0.0, -1.0, -math.pi, -20.0, -20.0, -100.0, *robot.joint_position_limit[0], *robot.joint_velocity_limit[0]]
    high = [3.02, 1.0, math.pi, 20.0, 20.0, 100.0, *robot.joint_position_limit[1], *robot.joint_velocity_limit[1]]
    if n_robots == 2:
        low += [1.5, -1.5, -1.5]
        high += [4.5, 1.5, 1.5]
    return Box(np.array(low), np.array(high))


def torque_box(robot: RobotSpec, n_robots: int) -> Box:
    """Bounds of the motors' torques, in [N·m]: what the official package calls the action space, whatever the order."""
    limit = np.tile([link.torque_limit for link in robot.links], n_robots)
    return Box(-limit, limit)


def make_env_info(name: str, simulation: Simulation, rules: Edition, horizon: int) -> dict[str, Any]:
    """Build the dictionary that agents are constructed with (challenge page, section 7)."""
    robot, n_robots = simulation.robot, simulation.n_robots
    n = robot.n_joints
    env_info = {
        "table": {"length": TABLE.length, "width": TABLE.width, "goal_width": TABLE.goal_width},
        "puck": {"radius": PUCK.radius},
        "mallet": {"radius": MALLET.radius},
        "n_agents": n_robots,
        "robot": _robot_info(simulation),
        "puck_pos_ids": [0, 1, 2],
        "puck_vel_ids": [3, 4, 5],
        "joint_pos_ids": list(range(6, 6 + n)),
        "joint_vel_ids": list(range(6 + n, 6 + 2 * n)),
        "opponent_ee_ids": list(range(6 + 2 * n, 9 + 2 * n)) if n_robots == 2 else [],
        "dt": CONTROL_PERIOD,
        "rl_info": RLInfo(
            observation_space=observation_box(robot, n_robots),
            action_space=torque_box(robot, n_robots),
            gamma=rules.discount,
            horizon=horizon,
            dt=CONTROL_PERIOD,
        ),
    }
    env_info["constraints"] = challenge_constraints(env_info)
    env_info["env_name"] = name
    return env_info


def _robot_info(simulation: Simulation) -> dict[str, Any]:
    robot = simulation.robot
    info = {
        "n_joints": robot.n_joints,
        "ee_desired_height": robot.desired_height,
        "joint_vel_limit": robot.joint_velocity_limit.copy(),
        "joint_acc_limit": robot.joint_acceleration_limit.copy(),
        "base_frame": [frame.copy() for frame in robot.base_frames[: simulation.n_robots]],
        "control_frequency": round(1.0 / CONTROL_PERIOD),
        "joint_pos_limit": robot.joint_position_limit.copy(),
        "robot_model": simulation.robot_model,
        "robot_data": simulation.robot_data,
    }
    return info if robot.universal_height is None else info | {"universal_height": robot.universal_height}
