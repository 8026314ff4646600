"""What an agent saw and did, episode by episode, from a folder of results: what every data set is made of."""

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.actions import ActionFormat
from airhockey.envs.editions import ROBOTS, edition
from airhockey.envs.specs import IIWA, RobotSpec
from airhockey.errors import ConfigurationError, unknown
from airhockey.evaluator.runs.game_records import SIDES, GameRecord, Side
from airhockey.evaluator.runs.game_trajectories import read_film
from airhockey.evaluator.runs.reader import Games, Run, short_name
from airhockey.evaluator.runs.records import EpisodeRecord, Order
from airhockey.evaluator.runs.trajectories import read_episode
from airhockey.inputs.broken import reading_errors

Array = NDArray[np.float64]
GAME = "tournament"
COMMANDS, ACHIEVED = "what the agent commanded", "where the joints were a control step later"


@dataclass(frozen=True)
class Demonstration:
    """One episode, or a game from a serve to the next.

    Attributes:
        name: In its folder, as in "17", or "0/home/3": game, side, serve.
        observations: As the agent was given them, in its robot's frame. Shape (T + 1, d).
        actions: In the shape of its interpolation order. Shape (T, …).
        rewards: 1 at the end of an episode that succeeded; in a game 1 for a point and -1 for the opponent's. Shape (T,).
        success: Whether the task was achieved; of a serve, whether it ended with this side's point.
        terminated: Whether the rules ended it, and not the time or the agent's failure.
    """

    name: str
    observations: Array
    actions: Array
    rewards: Array
    success: bool
    terminated: bool

    @property
    def steps(self) -> int:
        """Its length in control steps."""
        return len(self.actions)


@dataclass(frozen=True)
class Demonstrations:
    """Episodes of one environment, read one at a time.

    Attributes:
        env, edition: Where they were played.
        agent: By whom.
        order: The interpolation order of the actions.
        meaning: What the actions are: `COMMANDS`, or `ACHIEVED`, since a game keeps positions and no commands.
        disturbances: Name of a profile or path of a file; "" where nobody knows.
        names: Of the episodes.
        read: Reads one, by its name.
    """

    env: str
    edition: str
    agent: str
    order: int | None
    meaning: str
    disturbances: str
    names: list[str]
    read: Callable[[str], Demonstration]

    def __iter__(self) -> Iterator[Demonstration]:
        return map(self.read, self.names)

    def __len__(self) -> int:
        return len(self.names)

    @property
    def robot(self) -> RobotSpec:
        """The arm."""
        return ROBOTS[edition(self.edition).environment(self.env).robot]

    @property
    def form(self) -> ActionFormat:
        """The shape of an action."""
        return ActionFormat(self.order, self.robot.n_joints)

    def set_points(self, actions: Array) -> Array:
        """Joint positions at the ends of control steps, then their velocities and accelerations as far as actions hold them.

        Args:
            actions: Of a demonstration. Shape (T, …).

        Returns:
            In [rad] and per [s]. Shape (T, 1 to 3, n).
        """
        ends = actions[:, -1] if self.order is None else actions  # of 20 set-points, the last one counts
        return ends.reshape(len(ends), -1, self.robot.n_joints)

    def chosen(self, names: str | None) -> "Demonstrations":
        """Those of these names, separated by commas, or of the names that begin so, as "0/home" does; all for None.

        Raises:
            ConfigurationError: There is none of a name.
        """
        if names is None:
            return self
        found: list[str] = []
        for asked in filter(None, (name.strip() for name in names.split(","))):
            of_it = [name for name in self.names if name == asked or name.startswith(f"{asked}/")]
            if not of_it:
                raise ConfigurationError(f"there is no episode {asked!r}; there are {_few(self.names)}")
            found += of_it
        return Demonstrations(**(vars(self) | {"names": list(dict.fromkeys(found))}))


def of_run(run: Run, env: str | None = None) -> Demonstrations:
    """The episodes of a run, in one of its environments.

    Args:
        run: Of `hockey evaluate`.
        env: Which environment; it may be left out where there is one.

    Raises:
        ConfigurationError: There is no such environment, or there are several, or nothing was stored.
    """
    stored = [record for record in run.records if record.job in run.stored and record.steps]
    there = list(dict.fromkeys(record.env for record in stored))
    if not there:
        raise ConfigurationError(f"there are no trajectories in {str(run.path)!r} to export")
    if env is None and len(there) > 1:
        raise ConfigurationError(
            f"there are episodes of {', '.join(there)} in {str(run.path)!r}, and a data set has those of one: name it with --env"
        )
    if env is not None and env not in there:
        raise unknown("environment", env, there)
    records = {str(record.index): record for record in stored if record.env == (env or there[0])}
    first = next(iter(records.values()))
    options = run.manifest.options if run.manifest else None
    return Demonstrations(
        env=first.env,
        edition=first.edition,
        agent=run.agent,
        order=_order(first, options.interpolation_order if options else "agent"),
        meaning=COMMANDS,
        disturbances=options.disturbances if options else "",
        names=list(records),
        read=lambda name: _episode(run.stored[records[name].job], name, records[name]),
    )


def of_games(games: Games[Any], side: Side) -> Demonstrations:
    """The games of a match or a tournament as one side saw them, a piece for every serve.

    Args:
        games: Of `hockey match`, `hockey tournament` or `hockey play`.
        side: Whose.

    Raises:
        ConfigurationError: There is none.
    """
    pieces: dict[str, tuple[Path, GameRecord, int, int]] = {}
    for record in games.records:
        film = games.film(record)
        serves = sorted({event.step for event in record.events if event.what == "serve"} | {0, record.steps})
        for k, (begin, end) in enumerate(itertools.pairwise(serves)):
            if film is not None and end - begin > 1:
                pieces[f"{record.key}/{side}/{k}"] = film, record, begin, end
    if not pieces:
        raise ConfigurationError(f"there is no film of a game in {str(games.path)!r} to export")
    first = next(iter(pieces.values()))[1]
    players = dict.fromkeys(record.job.home if side == SIDES[0] else record.job.away for record in games.records)
    return Demonstrations(
        env=GAME,
        edition=first.edition,
        agent=" and ".join(map(short_name, players)),
        order=3,
        meaning=ACHIEVED,
        disturbances=games.disturbances,
        names=list(pieces),
        read=lambda name: _serve(name, *pieces[name], side),
    )


def in_robot_frame(rows: Array, side: int) -> Array:
    """Base observations of a game as one player sees them.

    Args:
        rows: Home's row and away's, in world coordinates. Shape (T, 46).
        side: 0 for home, 1 for away.

    Returns:
        Shape (T, 23).
    """
    n = IIWA.n_joints
    seen = rows.reshape(len(rows), 2, -1)[:, side].copy()
    facing, base = (1.0, -1.0)[side], np.array(IIWA.base_positions[side])
    turn = np.array([facing, facing, 1.0])
    seen[:, :2] = (seen[:, :2] - base[:2]) * facing
    if side:
        seen[:, 2] = np.pi - (-seen[:, 2]) % (2.0 * np.pi)
    seen[:, 3:5] *= facing
    tip = slice(6 + 2 * n, 9 + 2 * n)
    seen[:, tip] = (seen[:, tip] - base) * turn
    return seen


def _episode(file: Path, name: str, record: EpisodeRecord) -> Demonstration:
    with reading_errors(file):
        arrays = read_episode(file, record.env, record.index)
        rewards = np.zeros(record.steps)
        rewards[-1] = float(record.success)
        return Demonstration(
            name, arrays["observations"], arrays["actions"], rewards, record.success, terminated=record.absorbing
        )


def _serve(name: str, film: Path, record: GameRecord, begin: int, end: int, side: Side) -> Demonstration:
    with reading_errors(film):
        rows = read_film(film, slice(begin, end)).astype(np.float64)
    seen, n = in_robot_frame(rows, SIDES.index(side)), IIWA.n_joints
    joints = seen[1:, 6 : 6 + 2 * n].reshape(-1, 2, n)
    points = [event for event in record.events if event.what in ("goal", "point") and begin < event.step <= end]
    won = bool(points) and points[-1].who == side
    rewards = np.zeros(len(joints))
    rewards[-1] = (1.0 if won else -1.0) if points else 0.0
    return Demonstration(name, seen, joints, rewards, won, terminated=end < record.steps or bool(points))


def _order(record: EpisodeRecord, asked: Order) -> int | None:
    """As the record says; older ones leave it to the options, and those to the agent, of which most want 3."""
    told = record.interpolation_order if record.interpolation_order is not None else asked
    return None if told == "none" else 3 if told == "agent" else int(told)


def _few(names: list[str], most: int = 8) -> str:
    return ", ".join(names[:most]) + (f", … {names[-1]} ({len(names)} in all)" if len(names) > most else "")
