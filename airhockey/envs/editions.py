"""The rules of one year's challenge, as data: `edition("2023")` reads `assets/editions/2023.yaml`.

Ranges and names may differ between editions; code asks the edition and knows no number of its own.
"""

from collections.abc import Iterable
from functools import cache
from importlib import resources
from typing import Any

import msgspec

from airhockey.envs.specs import IIWA, MALLET, PLANAR, PUCK, TABLE, RobotSpec
from airhockey.errors import ConfigurationError, unknown
from airhockey.inputs.plain_yaml import load_yaml

Range = tuple[float, float]
DEFAULT = "2023"
ROBOTS: dict[str, RobotSpec] = {"planar": PLANAR, "iiwa": IIWA}

_LENGTHS = {
    "hit_width": TABLE.width / 2 - PUCK.radius - 2 * MALLET.radius,
    "goal_half_width": TABLE.goal_width / 2,
    "half_length": TABLE.length / 2,
    "half_width": TABLE.width / 2,
}


class Horizon(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Control steps in an episode of a task, and in a game."""

    task: int
    game: int


class Over(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Thresholds that end an episode, in [m/s] and [m]."""

    max_speed: float
    standstill: float
    middle_line: float


class Success(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Where, and how slow, the puck must be at the end of defend and prepare, in [m] and [m/s]."""

    near_x: float
    far_x: float
    slow: float
    band_half_width: float


class GameRules(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Faults and stuck pucks, in [s], [m] and [m/s]."""

    fault_time: float
    faults_per_point: int
    middle_zone: float
    stuck_speed: float


class Start(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Ranges of the puck's start in world coordinates: [m], [m/s], [rad], [rad/s]; at rest without the last three."""

    x: Range
    y: Range
    speed: Range | None = None
    angle: Range | None = None
    yaw_rate: Range | None = None
    reach: float | None = None
    """The motion is drawn again until a second of it leads to |y| below this, in [m]."""

    @property
    def area(self) -> float:
        """Size of the region, in [m²]."""
        return (self.x[1] - self.x[0]) * (self.y[1] - self.y[0])


class EnvironmentRules(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What an environment consists of: its arms, its task (a page of `airhockey.envs.tasks`) and the task's starts.

    Attributes:
        also: Another name for it: the one in the scheme of all editions.
    """

    robot: str
    robots: int
    kind: str
    start: tuple[str, ...]
    opponent: str | None = None
    also: str | None = None


class Scene(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How an edition's scene differs from another's.

    Attributes:
        mallet_priority: Of the mallets of robot 1 and robot 2 (iiwa) in contacts: the higher one's friction holds.
        arms_collide: Whether the mallets can touch each other.
        target: Whether the rim carries a mark that is only seen.
    """

    mallet_priority: tuple[int, int] = (0, 0)
    arms_collide: bool = True
    target: bool = False


class TimePenalty(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Points for an episode whose longest `draw_action` (or its mean) took more than so many seconds."""

    max_above: float
    points: float
    mean_above: float = float("inf")


class Deployability(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Most penalty points of a run (1000 episodes) that is still deployable, or still improvable."""

    deployable: float
    improvable: float

    def class_of(self, penalty: float) -> str:
        """The class of a run with so many penalty points."""
        if penalty <= self.deployable:
            return "Deployable"
        return "Improvable" if penalty <= self.improvable else "Non-deployable"


class Edition(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """All the rules of one edition; the fields are explained in its YAML file."""

    edition: str
    horizon: Horizon
    discount: float
    over: Over
    success: Success
    game: GameRules
    starts: dict[str, Start]
    scene: Scene
    environments: dict[str, EnvironmentRules]
    penalty_points: dict[str, float]
    computation_time: tuple[TimePenalty, ...]
    deployability: Deployability
    game_penalty_per_episode: float
    score_weights: dict[str, dict[str, float]]
    phases: dict[str, str]

    @property
    def tasks(self) -> tuple[str, ...]:
        """The names of the environments that one player plays."""
        return tuple(name for name, rules in self.environments.items() if rules.kind != "game")

    def tasks_of(self, robot: str) -> tuple[str, ...]:
        """The tasks of a robot ("3dof", "7dof") that its score consists of.

        Raises:
            ConfigurationError: This edition has no such robot.
        """
        if robot not in self.score_weights:
            raise unknown(f"robot of edition {self.edition}", robot, self.score_weights)
        return tuple(self.score_weights[robot])

    def environment(self, name: str) -> EnvironmentRules:
        """The rules of one environment; raises `ConfigurationError` for a name that this edition does not have."""
        return self.environments[self.official_name(name)]

    @property
    def names(self) -> dict[str, str]:
        """Every name that an environment can be given by -> its name in this edition."""
        others = {rules.also: official for official, rules in self.environments.items() if rules.also is not None}
        return {name: name for name in self.environments} | others

    def official_name(self, name: str) -> str:
        """The name of an environment in this edition, from that or from the one in the scheme of all editions ("7dof-hit").

        Raises:
            ConfigurationError: This edition has no such environment.
        """
        if name in self.names:
            return self.names[name]
        error = unknown(f"environment of edition {self.edition}", name, self.names)
        home = edition_of_names((name,))
        raise error if home is None else ConfigurationError(f"{error}; edition {home} has it")

    def counterpart(self, name: str) -> str:
        """The name here of an environment that is called so in any edition; raises `ConfigurationError` where there is none."""
        if name not in self.names:
            elsewhere = (edition(year).environments.get(name) for year in available())
            others = (rules.also for rules in elsewhere if rules is not None)
            name = next((other for other in others if other in self.names), name)
        return self.official_name(name)

    def starts_of(self, name: str) -> tuple[Start, ...]:
        """The areas in which the puck of an environment starts."""
        return tuple(self.starts[start] for start in self.environment(name).start)

    @property
    def deployability_limits(self) -> Range:
        """Most points of the classes Deployable and Improvable."""
        return self.deployability.deployable, self.deployability.improvable

    def time_penalty(self, longest: float, mean: float) -> float:
        """Points for an episode's computation times, in [s] (challenge rules, section "computation time")."""
        for rule in self.computation_time:
            if longest > rule.max_above or mean > rule.mean_above:
                return rule.points
        return 0.0


def available() -> tuple[str, ...]:
    """The names of the editions in this package."""
    folder = resources.files("airhockey.envs").joinpath("assets/editions")
    return tuple(sorted(entry.name.removesuffix(".yaml") for entry in folder.iterdir() if entry.name.endswith(".yaml")))


def edition_of_names(names: Iterable[str]) -> str | None:
    """The edition that calls its environments so, as 2025 does with "hit"; None where that is not one edition alone."""
    officially = {name: {year for year in available() if name in edition(year).environments} for name in names}
    years = {year for found in officially.values() if len(found) == 1 for year in found}
    return years.pop() if len(years) == 1 else None


@cache
def edition(name: str = DEFAULT) -> Edition:
    """Read and check an edition of the rules.

    Raises:
        ConfigurationError: No such edition, or its file is not valid.
    """
    if name not in available():
        raise unknown("edition", name, available())
    text = resources.files("airhockey.envs").joinpath(f"assets/editions/{name}.yaml").read_text(encoding="utf-8")
    try:
        return msgspec.convert(_with_lengths(load_yaml(text, f"{name}.yaml", aliases=True)), Edition)
    except msgspec.ValidationError as error:
        raise ConfigurationError(f"edition {name!r} is not valid: {error}") from error


def _with_lengths(value: Any) -> Any:
    """Replace the names of lengths, or their negatives, by numbers."""
    if isinstance(value, dict):
        return {key: _with_lengths(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_with_lengths(item) for item in value]
    if isinstance(value, str) and value.removeprefix("-") in _LENGTHS:
        length = _LENGTHS[value.removeprefix("-")]
        return -length if value.startswith("-") else length
    return value
