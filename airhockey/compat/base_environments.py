"""The base environments of the challenge's package: the scene without its wrapper, for training and for deriving one's own.

Observations are base observations, in world coordinates, until `_modify_observation` turns them into the robots' frames. A plain
base environment takes torques; `PositionControl` (in `environments.position_control_wrapper`) makes it take set-points.
Scene, starts and control step are those of `airhockey.envs`.
"""

from typing import Any

import mujoco
import numpy as np
from mushroom_rl.core import Environment
from numpy.typing import NDArray

from airhockey import envs
from airhockey.compat.air_hockey_challenge.utils.universal_joint_plugin import UniversalJointPlugin
from airhockey.compat.rl_info import mdp_info
from airhockey.envs.copying import Copyable
from airhockey.envs.specs import JOINT_VELOCITY_FILTER, TABLE

Array = NDArray[np.float64]
MAX_SPEED = 100.0
"""Of the puck, beyond which the simulation is not to be believed, in [m/s] and [rad/s] together."""


class BaseEnvironment(Copyable, Environment):
    """A scene of one or two robots, moved by torques. Its copies have a simulation of their own, and the same future.

    A subclass may give `setup(obs)`, `reward(state, action, next_state, absorbing)`, `is_absorbing(obs)` and
    `_modify_observation(obs)`.

    Args:
        gamma, horizon: Of `info`.
        n_intermediate_steps: Simulation steps in one step of this environment.
        viewer_params: Not used: what was recorded is shown by `hockey replay`.

    Attributes:
        env_info: What agents are built with.
        n_agents: Number of robots.
        _model, _data: MuJoCo's.
    """

    _scene = ""
    """Name of the environment of `airhockey.envs` whose scene and start this is."""
    _starts = False
    """Whether the puck starts as in that environment, or rests in the middle."""

    def __init__(
        self,
        gamma: float = 0.99,
        horizon: int = 500,
        timestep: float = 0.001,
        n_intermediate_steps: int = 20,
        n_substeps: int = 1,
        n_agents: int | None = None,
        viewer_params: Any = None,
        **kwargs: Any,
    ) -> None:
        self._env = envs.make(self._scene, getattr(self, "_order", 3))
        self._env._start_random = np.random.mtrand._rand  # agents seed their runs with np.random.seed
        self._env.new_game()
        self.env_info = self._env.env_info
        info = self.env_info["rl_info"]
        info.gamma, info.horizon = gamma, horizon
        self.env_info["rl_info"] = mdp_info(info)
        super().__init__(self.env_info["rl_info"])
        self._bind()
        self._model.opt.timestep = timestep
        self._substeps = n_intermediate_steps * n_substeps
        self.n_agents = self._env.n_agents
        self.init_state = np.array(self._env.simulation.robot.start)
        self.universal_joint_plugin = (
            UniversalJointPlugin(self._model, self._data, self.env_info) if self._is_iiwa else None
        )
        names = [f"{self._prefix}_{r + 1}/joint_{k + 1}" for r in range(self.n_agents) for k in range(self._n)]
        self._motors = [self._model.actuator(name).id for name in names]
        self._torque_limit = self.env_info["rl_info"].action_space.high
        self._velocity = np.zeros((self.n_agents, self._n))
        self._obs = np.zeros(0)

    def _bind(self) -> None:
        """Show what is the environment's."""
        self.env_info = self._env.env_info
        self._model, self._data = self._env.simulation.model, self._env.simulation.data
        self.robot_model, self.robot_data = self.env_info["robot"]["robot_model"], self.env_info["robot"]["robot_data"]

    def __getstate__(self) -> dict[str, Any]:
        """All but what is the environment's, which the copy binds anew."""
        shared = ("env_info", "_mdp_info", "_model", "_data", "robot_model", "robot_data")
        plugin = self.universal_joint_plugin
        return {name: value for name, value in self.__dict__.items() if name not in shared} | {
            "universal_joint_plugin": None if plugin is None else plugin.bound_to(None, None, None)
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._bind()
        self._mdp_info = self.env_info["rl_info"]
        if self.universal_joint_plugin is not None:
            self.universal_joint_plugin = self.universal_joint_plugin.bound_to(self._model, self._data, self.env_info)

    def seed(self, seed: int) -> None:
        """Seed NumPy's global generator, from which starts are drawn."""
        np.random.seed(seed)

    def reset(self, obs: Array | None = None) -> Array:
        """Begin an episode.

        Args:
            obs: A base observation to start from.
        """
        self._env.reset(state=obs)
        if not self._starts and obs is None:
            for name in ("puck_x", "puck_y", "puck_yaw"):
                self._data.joint(name).qpos, self._data.joint(name).qvel = 0.0, 0.0
        self.setup(obs)
        self._settle()
        self._obs = self._create_observation()
        return self._modify_observation(self._obs)

    def step(self, action: Any) -> tuple[Array, float, bool, dict[str, Any]]:
        """Advance by one step: new observation, reward, whether the episode is over, and nothing more."""
        before = self._obs
        self._advance(action)
        self._obs = self._create_observation()
        absorbing = self.is_absorbing(self._obs)
        reward = self.reward(before, action, self._obs, absorbing)
        return self._modify_observation(self._obs), reward, absorbing, {}

    def setup(self, obs: Array | None) -> None:
        """Place things after the official start was drawn, by `_write_data`."""

    def reward(self, state: Array, action: Any, next_state: Array, absorbing: bool) -> float:
        """Nothing: trainers bring their own."""
        return 0.0

    def is_absorbing(self, obs: Array) -> bool:
        """Whether the puck has left the table, or moves faster than anything real."""
        position, velocity = self.get_puck(obs)
        outside = abs(position[0]) > TABLE.length / 2 or abs(position[1]) > TABLE.width / 2
        return bool(outside or np.linalg.norm(velocity) > MAX_SPEED)

    def stop(self) -> None:
        """Nothing to stop."""

    def get_puck(self, obs: Array) -> tuple[Array, Array]:
        """Position (x, y, yaw) and velocity of the puck in a base observation, each of shape (3,)."""
        return obs[:3], obs[3:6]

    def get_joints(self, obs: Array, agent: int | None = None) -> tuple[Array, Array]:
        """Joint positions and velocities in a base observation: of a robot (1 or 2), or of all. Shapes (n,) or (robots·n,)."""
        rows = obs.reshape(self.n_agents, -1)
        rows = rows if agent is None else rows[agent - 1 : agent]
        return rows[:, 6 : 6 + self._n].flatten(), rows[:, 6 + self._n : 6 + 2 * self._n].flatten()

    def get_ee(self, robot: int = 1) -> tuple[Array, Array]:
        """World position (3,) and velocity (angular, then linear; 6,) of a robot's end-effector frame."""
        spec = self._env.simulation.robot
        body = self._model.body(f"{spec.prefix}_{robot}/{spec.end_effector}").id
        velocity = np.empty(6)
        mujoco.mj_objectVelocity(self._model, self._data, mujoco.mjtObj.mjOBJ_BODY, body, velocity, 0)
        return self._data.xpos[body].copy(), velocity

    @property
    def _n(self) -> int:
        return int(self.env_info["robot"]["n_joints"])

    @property
    def _prefix(self) -> str:
        return self._env.simulation.robot.prefix

    @property
    def _is_iiwa(self) -> bool:
        return "universal_height" in self.env_info["robot"]

    def _advance(self, action: Any) -> None:
        """Torques of all joints for one step."""
        torque = np.clip(np.asarray(action, dtype=np.float64).reshape(self._torque_limit.shape), *self._bounds)
        for _ in range(self._substeps):
            self._data.ctrl[self._motors] = torque
            if self.universal_joint_plugin is not None:
                self.universal_joint_plugin.update()
            mujoco.mj_step(self._model, self._data)
            self._velocity += JOINT_VELOCITY_FILTER * (self._joint_values("qvel") - self._velocity)

    @property
    def _bounds(self) -> tuple[Array, Array]:
        return -self._torque_limit, self._torque_limit

    def _settle(self) -> None:
        """Begin from what MuJoCo's data hold now."""
        if self.universal_joint_plugin is not None:
            self.universal_joint_plugin.reset()
        mujoco.mj_fwdPosition(self._model, self._data)
        self._velocity = self._joint_values("qvel")

    def _create_observation(self) -> Array:
        """The base observation: puck, joints and, with two robots, the other one's rod tip; one row a robot."""
        puck = np.concatenate((self._data.qpos[-3:], self._data.qvel[-3:]))
        puck[2] = (puck[2] + np.pi) % (2.0 * np.pi) - np.pi
        positions, rows = self._joint_values("qpos"), []
        for r in range(self.n_agents):
            other = self.get_ee(2 - r)[0] if self.n_agents == 2 else np.zeros(0)
            rows.append(np.concatenate((puck, positions[r], self._velocity[r], other)))
        return np.concatenate(rows)

    def _modify_observation(self, obs: Array) -> Array:
        """The base observation in the frames of the robots."""
        rows = obs.reshape(self.n_agents, -1).copy()
        for row, frame in zip(rows, self.env_info["robot"]["base_frame"], strict=True):
            side, base_x = frame[0, 0], frame[0, 3]
            row[0], row[1] = side * (row[0] - base_x), side * row[1]
            row[3:5] *= side
            if side < 0.0:
                row[2] += np.pi if row[2] <= 0.0 else -np.pi
            if self.n_agents == 2:
                row[-3:] = side * (row[-3] - base_x), side * row[-2], row[-1] - frame[2, 3]
        return rows.flatten()

    def _joint_values(self, kind: str) -> Array:
        """Positions or velocities as MuJoCo has them. Shape (robots, n)."""
        values = [
            [getattr(self._data.joint(f"{self._prefix}_{r + 1}/joint_{k + 1}"), kind)[0] for k in range(self._n)]
            for r in range(self.n_agents)
        ]
        return np.array(values)

    def _read_data(self, name: str) -> Array:
        """A joint's position or velocity by its official name, as in "puck_x_pos" or "robot_1/joint_3_vel"."""
        joint, kind = self._joint(name)
        return np.array(getattr(joint, kind))

    def _write_data(self, name: str, value: Any) -> None:
        """Set a joint's position or velocity; see `_read_data`."""
        joint, kind = self._joint(name)
        setattr(joint, kind, value)

    def _joint(self, name: str) -> tuple[Any, str]:
        joint, _, kind = name.rpartition("_")
        joint = joint.replace("robot_", f"{self._prefix}_", 1) if joint.startswith("robot_") else joint
        if kind not in ("pos", "vel"):
            raise KeyError(
                f"{name!r} is no name of a position or velocity, as 'puck_x_pos' and 'robot_1/joint_3_vel' are"
            )
        return self._data.joint(joint), f"q{kind}"


class Hit(BaseEnvironment):
    """Over when the puck comes back from the other half."""

    _starts = True

    def is_absorbing(self, obs: Array) -> bool:
        """Also when the puck is in the other half and moves back."""
        position, velocity = self.get_puck(obs)
        return super().is_absorbing(obs) or bool(position[0] > 0.0 and velocity[0] < 0.0)

    def _modify_observation(self, obs: Array) -> Array:
        """What player 1 sees."""
        return super()._modify_observation(obs)[: obs.size // self.n_agents]


class Defend(BaseEnvironment):
    """Over when the puck has gone back, or rests."""

    _starts = True

    def is_absorbing(self, obs: Array) -> bool:
        """Also when the puck is in the other half and moves away, or is slow."""
        position, velocity = self.get_puck(obs)
        away = position[0] > 0.0 and velocity[0] > 0.0
        return super().is_absorbing(obs) or bool(away or np.linalg.norm(velocity[:2]) < 0.1)


class Prepare(BaseEnvironment):
    """Over when the puck leaves the player's half, or is in the middle."""

    _starts = True

    def is_absorbing(self, obs: Array) -> bool:
        """Also when the puck is in the other half, or near the middle line along the table."""
        position, _ = self.get_puck(obs)
        return super().is_absorbing(obs) or bool(position[0] > 0.0 or abs(position[1]) < 0.01)


class Tournament(BaseEnvironment):
    """Serves of a game; score and faults are the wrapper's."""

    _starts = True
