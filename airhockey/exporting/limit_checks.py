"""Whether an arm may follow a joint trajectory: the challenge's limits at every point and between the points."""

from collections.abc import Iterator

import msgspec
import numpy as np
from numpy.typing import NDArray

from airhockey import envs
from airhockey.envs.editions import ROBOTS
from airhockey.envs.specs import SOFT_LIMIT, RobotSpec
from airhockey.errors import ConfigurationError
from airhockey.exporting.joint_trajectory import JointTrajectory

Array = NDArray[np.float64]
BETWEEN = 4
"""Moments looked at from a point to the next, the point itself among them."""
ROUNDING = 1e-9
HEIGHTS = {
    "ee_constr": (
        "mallet beyond the own rim",
        "mallet beyond the right rim",
        "mallet beyond the left rim",
        "mallet below the table's height",
        "mallet above the table's height",
    ),
    "link_constr": ("wrist too low", "elbow too low"),
}
"""What a constraint's values mean, in their order."""


class Violation(msgspec.Struct, frozen=True, kw_only=True):
    """The first of its kind.

    Attributes:
        what: The limit.
        time: From the start, in [s].
        point: The latest point then, from 0.
        value, allowed: In `unit`; beyond the table, how far beyond is allowed.
        points: After how many points the limit is violated until the next, in all.
    """

    what: str
    time: float
    point: int
    value: float
    allowed: float
    unit: str
    points: int


class Verdict(msgspec.Struct, frozen=True, kw_only=True):
    """What the check found.

    Attributes:
        robot: Whose limits.
        points, seconds: Of the trajectory.
        violations: The first of every kind, the earliest first.
    """

    robot: str
    points: int
    seconds: float
    violations: tuple[Violation, ...]


def check(trajectory: JointTrajectory) -> Verdict:
    """Check a trajectory against the limits of the arm that has as many joints.

    Joint positions and velocities are held to 95 % of the arm's, as the challenge does, accelerations to the whole; the mallet
    has to stay over the table and at its height, elbow and wrist above theirs. Between two points the arm is taken to follow the
    cubic that meets positions and velocities of both, as controllers do.

    Raises:
        ConfigurationError: There is no arm with so many joints, or time does not go forward.
    """
    robots = {spec.n_joints: name for name, spec in ROBOTS.items()}
    n = len(trajectory.names)
    if n not in robots:
        raise ConfigurationError(
            f"the trajectory has {n} joints; the arms have {' or '.join(map(str, sorted(robots)))}"
        )
    backwards = np.flatnonzero(np.diff(trajectory.time) <= 0.0)
    if len(backwards):
        k = int(backwards[0])
        raise ConfigurationError(
            f"time does not go forward from point {k} ({trajectory.time[k]:.3f} s) to point {k + 1} "
            f"({trajectory.time[k + 1]:.3f} s)"
        )
    found = sorted(_violations(trajectory, ROBOTS[robots[n]]), key=lambda violation: violation.time)
    return Verdict(
        robot=robots[n],
        points=len(trajectory.time),
        seconds=float(trajectory.time[-1] - trajectory.time[0]),
        violations=tuple(found),
    )


def _violations(trajectory: JointTrajectory, spec: RobotSpec) -> Iterator[Violation]:
    time, position, velocity = _between(trajectory)
    soft_position, soft_velocity = SOFT_LIMIT * spec.joint_position_limit[1], SOFT_LIMIT * spec.joint_velocity_limit[1]
    names = trajectory.names
    yield from _beyond(trajectory, time, position, soft_position, [f"position of {name}" for name in names], "rad")
    yield from _beyond(trajectory, time, velocity, soft_velocity, [f"velocity of {name}" for name in names], "rad/s")
    yield from _beyond(
        trajectory,
        trajectory.time,
        trajectory.acceleration,
        spec.joint_acceleration_limit[1],
        [f"acceleration of {name}" for name in names],
        "rad/s²",
    )
    constraints = envs.make(f"{spec.n_joints}dof-hit").env_info["constraints"]
    for name in (name for name in HEIGHTS if name in constraints.keys()):  # noqa: SIM118 - a list by name, no mapping
        values = np.array([constraints.get(name).fun(q, dq) for q, dq in zip(position, velocity, strict=True)])
        yield from _beyond(trajectory, time, values, np.zeros(values.shape[1]), list(HEIGHTS[name]), "m", signed=True)


def _beyond(
    trajectory: JointTrajectory,
    time: Array,
    values: Array,
    limit: Array,
    names: list[str],
    unit: str,
    signed: bool = False,
) -> Iterator[Violation]:
    """The first moment at which each column is beyond its limit, in either direction unless `signed`."""
    beyond = (values if signed else np.abs(values)) > limit + ROUNDING
    for column in np.flatnonzero(beyond.any(axis=0)):
        moments = np.flatnonzero(beyond[:, column])
        k = moments[0]
        points = np.searchsorted(trajectory.time, time[moments] + ROUNDING) - 1
        yield Violation(
            what=names[column],
            time=float(time[k]),
            point=int(points[0]),
            value=float(values[k, column]),
            allowed=float(limit[column]),
            unit=unit,
            points=len(np.unique(points)),
        )


def _between(trajectory: JointTrajectory) -> tuple[Array, Array, Array]:
    """Time, position and velocity at the points and between them, on the cubics from each to the next."""
    if len(trajectory.time) == 1:
        return trajectory.time, trajectory.position, trajectory.velocity
    spans = np.diff(trajectory.time)[:, None, None]
    p0, p1 = trajectory.position[:-1, None], trajectory.position[1:, None]
    v0, v1 = trajectory.velocity[:-1, None] * spans, trajectory.velocity[1:, None] * spans
    s = (np.arange(BETWEEN) / BETWEEN)[None, :, None]
    rise, bend = p1 - p0, v0 + v1 - 2.0 * (p1 - p0)
    curve = rise - v0 - bend
    position = p0 + s * (v0 + s * (curve + s * bend))
    velocity = (v0 + s * (2.0 * curve + 3.0 * s * bend)) / spans
    time = trajectory.time[:-1, None] + s[0, :, 0] * spans[:, 0]
    n = trajectory.position.shape[1]
    last = trajectory.time[-1:], trajectory.position[-1:], trajectory.velocity[-1:]
    every = time.reshape(-1), position.reshape(-1, n), velocity.reshape(-1, n)
    return (
        np.concatenate([every[0], last[0]]),
        np.concatenate([every[1], last[1]]),
        np.concatenate([every[2], last[2]]),
    )
