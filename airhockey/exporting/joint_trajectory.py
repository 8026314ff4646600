"""Joint trajectories for a real arm: of a recorded episode or game, as CSV or as ROS 2's `JointTrajectory` in JSON.

CSV has a line of names, `time_from_start` and then `NAME.position`, `NAME.velocity` and `NAME.acceleration` of every joint.
JSON has the fields of `trajectory_msgs/msg/JointTrajectory`. Units are s, rad, rad/s and rad/s².
"""

import csv
import io
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.specs import CONTROL_PERIOD, JOINTS
from airhockey.errors import ConfigurationError
from airhockey.exporting.demonstrations import ACHIEVED, Demonstration, Demonstrations
from airhockey.inputs.broken import check_size, reading_errors

Array = NDArray[np.float64]
TIME, QUANTITIES = "time_from_start", ("position", "velocity", "acceleration")
FIELDS = ("positions", "velocities", "accelerations")
"""Their names in a message."""
LARGEST = 512 << 20
"""Of a file that is read, in bytes."""


@dataclass(frozen=True)
class JointTrajectory:
    """What an arm is to do.

    Attributes:
        names: Of the joints.
        time: From the start, in [s]. Shape (T,).
        position, velocity, acceleration: In [rad], [rad/s] and [rad/s²]. Each of shape (T, n).
    """

    names: tuple[str, ...]
    time: Array
    position: Array
    velocity: Array
    acceleration: Array


def trajectory_of(demonstrations: Demonstrations, demonstration: Demonstration) -> JointTrajectory:
    """What an arm would be told to do the same: where it was at the start, then every command at the end of its control step.

    Velocities that an action does not hold are the positions' differences, accelerations the velocities'. Of an action that is a
    trajectory of 20 set-points, the last one counts. What was recorded of a game are positions and velocities, and no commands.
    """
    n = demonstrations.robot.n_joints
    start, actions = demonstration.observations[0], demonstration.actions
    rows = demonstrations.set_points(actions)
    position: Array = np.concatenate([start[None, JOINTS : JOINTS + n], rows[:, 0]])
    velocity: Array
    acceleration: Array
    if rows.shape[1] > 1:
        velocity = np.concatenate([start[None, JOINTS + n : JOINTS + 2 * n], rows[:, 1]])
    else:
        velocity = np.gradient(position, CONTROL_PERIOD, axis=0)
    if rows.shape[1] > 2 and demonstrations.meaning != ACHIEVED:
        acceleration = np.concatenate([np.zeros((1, n)), rows[:, 2]])
    else:
        acceleration = np.gradient(velocity, CONTROL_PERIOD, axis=0)
    time: Array = CONTROL_PERIOD * np.arange(len(position), dtype=np.float64)
    return JointTrajectory(joint_names(demonstrations), time, position, velocity, acceleration)


def joint_names(demonstrations: Demonstrations) -> tuple[str, ...]:
    """`joint_1` and so on."""
    return tuple(f"joint_{k}" for k in range(1, demonstrations.robot.n_joints + 1))


def as_csv(trajectory: JointTrajectory) -> str:
    """A line per point; its numbers read back as they were, to the bit."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([TIME, *(f"{name}.{what}" for what in QUANTITIES for name in trajectory.names)])
    points = np.hstack((trajectory.position, trajectory.velocity, trajectory.acceleration))
    writer.writerows([f"{t:.3f}", *map(repr, row)] for t, row in zip(trajectory.time, points.tolist(), strict=True))
    return text.getvalue()


def as_ros2(trajectory: JointTrajectory) -> str:
    """The message, a point a line."""
    arrays = dict(zip(FIELDS, (trajectory.position, trajectory.velocity, trajectory.acceleration), strict=True))
    points = []
    for k, time in enumerate(trajectory.time):
        seconds, rest = divmod(round(time * 1e9), 10**9)
        point: dict[str, Any] = {field: array[k].tolist() for field, array in arrays.items()}
        points.append(point | {"effort": [], "time_from_start": {"sec": seconds, "nanosec": rest}})
    head = json.dumps({"header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}, "joint_names": trajectory.names})
    return head[:-1] + ', "points": [\n' + ",\n".join(map(json.dumps, points)) + "\n]}\n"


def read_trajectory(path: Path) -> JointTrajectory:
    """A trajectory in either format.

    Raises:
        ConfigurationError: It is none; the message says what is missing.
    """
    if not path.is_file():
        raise ConfigurationError(f"there is no file {str(path)!r}; hockey export RUN --format csv-joints writes some")
    check_size(path, LARGEST)
    with reading_errors(path):
        text = path.read_text()
        trajectory = _from_ros2(text, path) if text.lstrip().startswith("{") else _from_csv(text, path)
    arrays = trajectory.position, trajectory.velocity, trajectory.acceleration, trajectory.time
    if not all(np.isfinite(array).all() for array in arrays):
        raise ConfigurationError(f"{str(path)!r} holds numbers that are not finite")
    if not len(trajectory.time):
        raise ConfigurationError(f"{str(path)!r} holds no points")
    return trajectory


def _from_csv(text: str, path: Path) -> JointTrajectory:
    lines = csv.reader(io.StringIO(text))
    head = next(lines, [])
    names = tuple(column.removesuffix(".position") for column in head if column.endswith(".position"))
    missing = [
        column for column in (TIME, *(f"{name}.{what}" for name in names for what in QUANTITIES)) if column not in head
    ]
    if missing or not names:
        lacking = (missing or ["joint_1.position"])[0]
        raise ConfigurationError(
            f"{str(path)!r} has no column {lacking!r}; its first line names {TIME} and, for every joint, NAME.position, "
            "NAME.velocity and NAME.acceleration"
        )
    table = np.array([[float(cell) for cell in line] for line in lines if line]).reshape(-1, len(head))

    def of(what: str) -> Array:
        return table[:, [head.index(f"{name}.{what}") for name in names]]

    return JointTrajectory(names, table[:, head.index(TIME)], *map(of, QUANTITIES))


def _from_ros2(text: str, path: Path) -> JointTrajectory:
    message: dict[str, Any] = json.loads(text)
    for field in ("joint_names", "points"):
        if field not in message:
            raise ConfigurationError(f"{str(path)!r} has no {field!r}; it is no trajectory_msgs/msg/JointTrajectory")
    names, points = tuple(map(str, message["joint_names"])), message["points"]

    def of(field: str) -> Array:
        rows = [point.get(field) or [0.0] * len(names) for point in points]
        return np.array(rows, dtype=np.float64).reshape(-1, len(names))

    times = [point["time_from_start"]["sec"] + 1e-9 * point["time_from_start"]["nanosec"] for point in points]
    return JointTrajectory(names, np.array(times), *map(of, FIELDS))
