"""`env_info`: what an agent is told about the environment (keys of the official package), and its spaces."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.actions import ActionFormat
from airhockey.envs.constraints import ConstraintList
from airhockey.envs.editions import Edition
from airhockey.envs.simulation import Simulation
from airhockey.envs.specs import CONTROL_PERIOD, MALLET, PUCK, TABLE, RobotSpec

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Box:
    """An interval of arrays, with the attributes of a MushroomRL box."""

    low: Array
    high: Array

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of an element."""
        return self.low.shape


@dataclass(frozen=True)
class RLInfo:
    """Spaces, discount and horizon, with the attributes of MushroomRL's `MDPInfo`."""

    observation_space: Box
    action_space: Box
    gamma: float
    horizon: int
    dt: float


def observation_box(robot: RobotSpec, n_robots: int) -> Box:
    """Bounds of one player's observation in the robot frame."""
    low = [0.0, -1.0, -math.pi, -20.0, -20.0, -100.0, *robot.joint_position_limit[0], *robot.joint_velocity_limit[0]]
    high = [3.02, 1.0, math.pi, 20.0, 20.0, 100.0, *robot.joint_position_limit[1], *robot.joint_velocity_limit[1]]
    if n_robots == 2:
        low += [1.5, -1.5, -1.5]
        high += [4.5, 1.5, 1.5]
    return Box(np.array(low), np.array(high))


def make_env_info(
    name: str, simulation: Simulation, formats: list[ActionFormat], rules: Edition, horizon: int
) -> dict[str, Any]:
    """Build the dictionary that agents are constructed with (challenge page, section 7)."""
    robot, n_robots = simulation.robot, simulation.n_robots
    n = robot.n_joints
    action_space = Box(*formats[0].limits(robot))
    return {
        "env_name": name,
        "n_agents": n_robots,
        "dt": CONTROL_PERIOD,
        "table": {"length": TABLE.length, "width": TABLE.width, "goal_width": TABLE.goal_width},
        "puck": {"radius": PUCK.radius},
        "mallet": {"radius": MALLET.radius},
        "puck_pos_ids": [0, 1, 2],
        "puck_vel_ids": [3, 4, 5],
        "joint_pos_ids": list(range(6, 6 + n)),
        "joint_vel_ids": list(range(6 + n, 6 + 2 * n)),
        "opponent_ee_ids": list(range(6 + 2 * n, 9 + 2 * n)) if n_robots == 2 else [],
        "constraints": ConstraintList(simulation.arm),
        "robot": {
            "n_joints": n,
            "base_frame": [frame.copy() for frame in robot.base_frames[:n_robots]],
            "ee_desired_height": robot.desired_height,
            "universal_height": robot.universal_height,
            "joint_pos_limit": robot.joint_position_limit.copy(),
            "joint_vel_limit": robot.joint_velocity_limit.copy(),
            "joint_acc_limit": robot.joint_acceleration_limit.copy(),
            "control_frequency": round(1.0 / CONTROL_PERIOD),
            "robot_model": simulation.robot_model,
            "robot_data": simulation.robot_data,
        },
        "rl_info": RLInfo(
            observation_space=observation_box(robot, n_robots),
            action_space=action_space,
            gamma=rules.discount,
            horizon=horizon,
            dt=CONTROL_PERIOD,
        ),
    }
