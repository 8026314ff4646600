"""The simulation under the environment: one scene with its controllers, reset and advanced by control steps.

It knows nothing of tasks, and nothing of noise beyond adding the torques it is given. MuJoCo's objects live as long as it
does: compiled code knows only their addresses.
"""

from typing import Any, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from airhockey.envs import scene
from airhockey.envs.copying import Copyable
from airhockey.envs.editions import Scene
from airhockey.envs.kernel.arm import Arm, arm_from_model
from airhockey.envs.kernel.control_step import BAD_ACTION, DONE, Players, control_step
from airhockey.envs.kernel.controller import Controller, filter_velocity, new_controller
from airhockey.envs.kernel.engine import last_warnings
from airhockey.envs.kernel.kinematics import WorkSpace, link_rotations, work_space
from airhockey.envs.kernel.memory import bytes_from, pack, view
from airhockey.envs.kernel.observation import Readings, read, readings_of, readings_size
from airhockey.envs.kernel.opponent import Opponent, reset_opponent
from airhockey.envs.kernel.plant import Geometry, Plant, addresses_of
from airhockey.envs.kernel.universal_joint import clip_angle, desired_angles, rod_axes
from airhockey.envs.physics import Physics, PhysicsState
from airhockey.envs.specs import RobotSpec
from airhockey.errors import ActionError, SimulationError

Array = NDArray[np.float64]


class SimulationState(NamedTuple):
    """A moment of a simulation: the physics, what controllers and opponent remember, and the latest readings."""

    physics: PhysicsState
    memory: bytes
    flat: Array


class Simulation(Copyable):
    """A scene with its controllers. It can be copied and pickled: the copy has models and data of its own.

    Args:
        robot: Which arm plays.
        n_robots: 1 or 2.
        orders: Interpolation order of each robot, as compiled code wants it. Shape (n_robots,).
        moving_opponent: Robot 2 follows the figure of eight.
        visual: Draw the arms' links.
        edition_scene: What is particular to the edition's scene.

    Attributes:
        model, data: MuJoCo's. Changing them changes the simulation.
        robot_model, robot_data: The arm alone, nominal, as controller and agents know it.
        arm: The same as arrays.
        flat: What the latest reset or step left, a fresh array each time; `readings` divides it.
    """

    def __init__(
        self,
        robot: RobotSpec,
        n_robots: int,
        orders: NDArray[np.int64],
        moving_opponent: bool = False,
        visual: bool = False,
        edition_scene: Scene | None = None,
    ) -> None:
        self.robot, self.n_robots = robot, n_robots
        self.model = scene.game_model(robot, n_robots, visual, edition_scene)
        self.robot_model = scene.robot_model(robot)
        self.robot_data = mujoco.MjData(self.robot_model)
        data = mujoco.MjData(self.model)
        self.arm: Arm = arm_from_model(robot, self.robot_model)
        n = robot.n_joints
        self._n_constraints = 4 * n + (7 if self.arm.universal_joint else 5)
        self._size = readings_size(n_robots, n, self._n_constraints)
        self._memory = pack(
            addresses_of(self.model, data),
            self._geometry(data),
            self.arm,
            Players(moving_opponent, self._n_constraints, orders),
            new_controller(n_robots, n),
            work_space(n),
            Opponent(np.zeros(1), np.zeros(n), np.zeros(3)),
        )
        self._bind(data)
        self._start = np.tile(np.array(robot.start), (n_robots, 1))
        self._striker_start = [self._level_striker(row) for row in self._start] if self.arm.universal_joint else []
        self.reset(np.zeros(3), np.zeros(3))

    @property
    def readings(self) -> Readings:
        """Base observation (R, D), observations (R, D), constraints (R, K) and jerk (R, n): views of `flat`."""
        return readings_of(self.flat, self.n_robots, self.robot.n_joints, self._n_constraints)

    def reset(
        self,
        puck_position: Array,
        puck_velocity: Array,
        joint_position: Array | None = None,
        joint_velocity: Array | None = None,
    ) -> None:
        """Put everything in its place, at time zero.

        Args:
            puck_position, puck_velocity: (x, y, yaw) and its derivative in world coordinates. Shape (3,).
            joint_position, joint_velocity: Default: the start configuration, at rest. Shape (robots, n).
        """
        position = self._start if joint_position is None else joint_position
        velocity = np.zeros_like(position) if joint_velocity is None else joint_velocity
        data, controller, n = self.data, self._controller, self.robot.n_joints
        mujoco.mj_resetData(self.model, data)
        data.qpos[-3:], data.qvel[-3:] = puck_position, puck_velocity
        for r in range(self.n_robots):
            first = r * self._plant.stride
            data.qpos[first : first + n] = position[r]
            data.qvel[first : first + n] = velocity[r]
            if self.arm.universal_joint:
                data.qpos[first + n : first + n + 2] = self._striker_start[r]
        mujoco.mj_fwdPosition(self.model, data)
        controller.command[:, 0], controller.command[:, 1], controller.command[:, 2] = position, velocity, 0.0
        controller.clipped[:] = position
        controller.velocity[:] = velocity
        for r in range(self.n_robots):  # the official reset observation passes the filter once more
            filter_velocity(data.qvel, r * self._plant.stride, controller.velocity[r])
        controller.striker_average[:] = 0.0
        controller.striker_seen[:] = 0.0
        reset_opponent(self._opponent, self._start[-1])
        self.flat = np.zeros(self._size)
        read(self._plant, self.arm, controller, self._work, self.readings)
        last_warnings()

    def step(self, action: Array, noise: Array, step: int) -> None:
        """Advance by one control step; `flat` is then new.

        Args:
            action: Shape (robots, rows, n).
            noise: Torques added in each substep, in [N·m]. Shape (20, robots, n), or (0, robots, n) for none.
            step: Number of the step, for error messages.

        Raises:
            ActionError: The action is not finite, or so large that the torque is not.
            SimulationError: The engine warned.
        """
        before, self.flat = self.flat, np.empty(self._size)
        code: int = control_step(self._memory, action, noise, self.flat)
        if code == BAD_ACTION:
            self.flat = before
        if code != DONE:
            self.complain(code, action, step)

    def complain(self, code: int, action: Array, step: int) -> None:
        """Raise what a code of `control_step` other than `DONE` stands for; see `step`."""
        if code == BAD_ACTION:
            raise ActionError(f"step {step}: the action holds values that are not finite; all must be numbers")
        self.flat = np.full(self._size, np.nan)
        names = ", ".join(_warning_names(self.data.warning.number))
        if names:  # before the torque, which is not finite either once the state is not
            raise SimulationError(f"step {step}: MuJoCo warned ({names}): {last_warnings() or 'no message'}")
        if not (np.isfinite(self.data.qpos).all() and np.isfinite(self.data.qvel).all()):
            raise SimulationError(f"step {step}: the simulation diverged: positions or velocities are not finite")
        raise ActionError(
            f"step {step}: the action leads to a set-point or motor torque that is not a finite number "
            f"(largest entry {np.abs(action).max():.3g}); send positions in [rad] and velocities in [rad/s]"
        )

    def save(self) -> SimulationState:
        """All that the next steps depend on."""
        return SimulationState(self._physics.save(), self._remembered.tobytes(), self.flat.copy())

    def restore(self, state: SimulationState) -> None:
        """Go to a moment that this simulation, or one like it, saved."""
        self._physics.restore(state.physics)
        self._remembered[:] = state.memory
        self.flat = state.flat.copy()

    def __getstate__(self) -> dict[str, Any]:
        """Everything but addresses, views and MuJoCo's data, whose content is added."""
        views = ("data", "_physics", "_controller", "_work", "_opponent", "_plant", "_remembered")
        kept = {name: value for name, value in self.__dict__.items() if name not in views}
        return kept | {"_saved": self._physics.save()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        state = dict(state)
        saved = state.pop("_saved")
        self.__dict__.update(state)
        self._bind(mujoco.MjData(self.model))
        self._physics.restore(saved)

    def move_into(self, memory: NDArray[Any], flat: Array) -> None:
        """Work from now on in arrays of the caller's, who may step many simulations in one call.

        Args:
            memory: Of the type of `memory`. Shape (1,).
            flat: Shape of `flat`. Written now, and by whoever steps; `step` and `reset` leave a new one behind.
        """
        memory[:], self._memory = self._memory, memory
        flat[:], self.flat = self.flat, flat
        self._bind(self.data)

    @property
    def memory(self) -> NDArray[Any]:
        """The record that compiled code works in. Shape (1,)."""
        return self._memory

    def copy_robot_data(self) -> Any:
        """The robot-only model's data, copied, for the same model."""
        data = mujoco.MjData(self.robot_model)
        mujoco.mj_copyData(data, self.robot_model, self.robot_data)
        return data

    def _bind(self, data: Any) -> None:
        """Simulate with this data: make every address and view anew."""
        self.data = data
        self._physics = Physics(data)
        addresses = addresses_of(self.model, data)._asdict()
        for name, address in addresses.items():
            self._memory[name] = address
        self._controller: Controller = view(self._memory, Controller)
        self._work: WorkSpace = view(self._memory, WorkSpace)
        self._opponent: Opponent = view(self._memory, Opponent)
        arrays = {"ctrl": data.ctrl, "qpos": data.qpos, "qvel": data.qvel, "xpos": data.xpos}
        known = addresses | view(self._memory, Geometry)._asdict() | arrays
        self._plant = Plant(**{name: known[name] for name in Plant._fields})
        self._remembered = bytes_from(self._memory, Controller).data  # what comes before is the same at all times

    def _geometry(self, data: Any) -> Geometry:
        model, robot = self.model, self.robot
        bases = robot.base_positions[: self.n_robots]
        tips = [model.body(f"{robot.prefix}_{r + 1}/{robot.end_effector}").id for r in range(self.n_robots)]
        counts = data.warning.number
        return Geometry(
            tips=np.array(tips, dtype=np.int64),
            sides=np.array([1.0, -1.0][: self.n_robots]),
            base_x=np.array([base[0] for base in bases]),
            base_z=bases[0][2],
            stride=robot.n_joints + (2 if self.arm.universal_joint else 0),
            n_motors=model.nu,
            n_joints=model.nv,
            n_bodies=model.nbody,
            n_warnings=counts.size,
            warning_stride=counts.strides[0] // counts.itemsize,
        )

    def _level_striker(self, joint_position: Array) -> tuple[float, float]:
        """Angles of the universal joint that level the mallet, in [rad]."""
        rotations, rod = self._controller.rotations, self._controller.rod
        link_rotations(self.arm, joint_position, rotations)
        rod_axes(rotations, rod)
        first, second = desired_angles(rod)
        return clip_angle(first), clip_angle(second)


def _warning_names(counts: Any) -> list[str]:
    kinds = mujoco.mjtWarning
    return [
        name.removeprefix("mjWARN_").lower()
        for name, kind in kinds.__members__.items()
        if int(kind) < len(counts) and counts[int(kind)]
    ]
