"""Episodes that went wrong, and why: the task was not achieved, limits were violated, or the agent failed."""

from collections import Counter

import msgspec

from airhockey.envs.specs import CONTROL_PERIOD
from airhockey.evaluator.runs.reader import Run
from airhockey.evaluator.runs.records import EpisodeRecord
from airhockey.evaluator.runs.trajectories import read_episode
from airhockey.inputs.broken import BROKEN

TIME_IS_UP = "not achieved: the time was up"
ENDED = "not achieved: the task ended"
FAILED = "the agent failed"


class Failure(msgspec.Struct, frozen=True, kw_only=True):
    """One episode that went wrong.

    Attributes:
        env, index: Which.
        causes: Of what kinds, such as `TIME_IS_UP` or "violated joint_pos_constr".
        told: What the agent failed with; None where it did not.
        seconds: How long the episode lasted, in [s].
        start: x, y [m] and ẋ, ẏ [m/s] of the puck in the robot's frame, as first observed; None where that was not stored.
    """

    env: str
    index: int
    causes: tuple[str, ...]
    told: str | None
    seconds: float
    start: tuple[float, float, float, float] | None


def causes_of(record: EpisodeRecord) -> tuple[str, ...]:
    """What went wrong in an episode; empty where nothing did."""
    violated = tuple(f"violated {name}" for name, steps in sorted(record.violations.items()) if steps)
    if record.error is not None:
        return (FAILED, *violated)
    if record.success:
        return violated
    return (ENDED if record.absorbing else TIME_IS_UP, *violated)


def failures(run: Run) -> list[EpisodeRecord]:
    """The records of all episodes that went wrong, in the run's order."""
    return [record for env in run.environments for record in run.of(env) if causes_of(record)]


def by_cause(found: list[EpisodeRecord]) -> list[tuple[str, str, int]]:
    """Environment, cause and number of episodes, the most frequent first."""
    counts = Counter((record.env, cause) for record in found for cause in causes_of(record))
    return [(env, cause, number) for (env, cause), number in counts.most_common()]


def described(run: Run, record: EpisodeRecord) -> Failure:
    """One of them with its start, for which its trajectory is read."""
    return Failure(
        env=record.env,
        index=record.index,
        causes=causes_of(record),
        told=record.error,
        seconds=record.steps * CONTROL_PERIOD,
        start=_start(run, record),
    )


def _start(run: Run, record: EpisodeRecord) -> tuple[float, float, float, float] | None:
    """The first observation begins with the puck's x, y, yaw and their rates."""
    file = run.stored.get(record.job)
    if file is None or record.steps == 0:
        return None
    try:
        x, y, _, x_speed, y_speed = read_episode(file, record.env, record.index)["observations"][0][:5]
    except BROKEN:
        return None
    return float(x), float(y), float(x_speed), float(y_speed)
