"""What a training run is asked to do and what it leaves behind, as typed records that travel as JSON."""

from typing import Any, Generic, TypeVar

import msgspec

from airhockey.evaluator.runs.manifest import TrainingManifest

Options = TypeVar("Options")


class Settings(msgspec.Struct, frozen=True, kw_only=True):
    """Everything that a run's result depends on, besides the versions of the software.

    Attributes:
        task: "hit", "defend", "prepare", "home" or "switcher".
        robot: "3dof" or "7dof".
        seed: From it come the parameters tried and every episode.
        names: Of the parameters that are trained, d of them.
        mean, sigma: Of the distribution to start with.
        optimizer: "pgpe" or "cma".
        candidates: Parameters tried in each iteration, N.
        episodes: Played with each of them, M.
        iterations: How many.
        learning_rate, sigma_share, sigma_rule, schedule, natural, baseline, normalize, symmetric: See `Pgpe` and `schedule`.
        common_random_numbers: All candidates of an iteration play the same M episodes.
        discount: γ of the return.
        reward: "thesis", "sparse" (5.1: what the task was worth at its end, less the constraints') or "success" (1 for a
            success and 0 for a failure).
        fixed_start: What of the puck's start is the same in all episodes: "none", "position", "velocity" or "both" (5.2).
        max_penalty: Budget of penalty points per episode.
        multiplier_rate: η of the multiplier.
        disturbances: Name of a profile or absolute path of a YAML file.
    """

    task: str = "hit"
    robot: str = "7dof"
    seed: int = 0
    names: tuple[str, ...] = ()
    mean: tuple[float, ...] = ()
    sigma: tuple[float, ...] = ()
    optimizer: str = "pgpe"
    candidates: int = 12
    episodes: int = 5
    iterations: int = 40
    learning_rate: float = 1.0
    sigma_share: float = 0.5
    sigma_rule: str = "log"
    schedule: str = "constant"
    natural: bool = True
    baseline: str = "optimal"
    normalize: bool = True
    symmetric: bool = False
    common_random_numbers: bool = False
    discount: float = 0.997
    reward: str = "thesis"
    fixed_start: str = "none"
    max_penalty: float | None = None
    multiplier_rate: float = 0.5
    disturbances: str = "ideal"


class PgpeManifest(TrainingManifest[Options], Generic[Options], frozen=True, kw_only=True):
    """`train.json` of PGPE.

    Attributes:
        parameters: All the player's parameters at the start, as in a parameter file.
    """

    parameters: dict[str, Any]


class RolloutJob(msgspec.Struct, frozen=True):
    """One episode to play: with which parameters, and which of the iteration's it is."""

    iteration: int
    candidate: int
    episode: int
    theta: tuple[float, ...]


class Outcome(msgspec.Struct, frozen=True, kw_only=True):
    """What came of an episode.

    Attributes:
        value: Return.
        penalty: Points for violated constraints.
        error: What the player raised.
    """

    value: float = float("nan")
    success: bool = False
    penalty: float = 0.0
    violated: tuple[str, ...] = ()
    steps: int = 0
    error: str | None = None


class Iteration(msgspec.Struct, frozen=True, kw_only=True):
    """One line of the journal.

    Attributes:
        theta: What was tried. N × d.
        returns, penalties, successes: Means over each one's episodes. N each.
        violations: Constraint name -> share of the iteration's episodes that violated it.
        mean, sigma: Of the distribution after the update. d each.
        learning_rate, multiplier: Of the update.
        steps: Control steps played.
        seconds: It took.
    """

    iteration: int
    theta: tuple[tuple[float, ...], ...]
    returns: tuple[float, ...]
    penalties: tuple[float, ...]
    successes: tuple[float, ...]
    violations: dict[str, float]
    mean: tuple[float, ...]
    sigma: tuple[float, ...]
    learning_rate: float
    multiplier: float
    steps: int
    seconds: float

    @property
    def key(self) -> int:
        """Its number."""
        return self.iteration

    @property
    def mean_return(self) -> float:
        """Ĵ(ρ) of (2.8)."""
        return sum(self.returns) / len(self.returns)

    @property
    def mean_success(self) -> float:
        """Share of successes."""
        return sum(self.successes) / len(self.successes)

    @property
    def mean_penalty(self) -> float:
        """Penalty points per episode."""
        return sum(self.penalties) / len(self.penalties)
