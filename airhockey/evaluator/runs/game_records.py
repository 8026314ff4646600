"""What a game is asked to be and what it leaves behind, as typed records that travel as JSON."""

from collections.abc import Sequence
from typing import Literal

import msgspec

from airhockey.envs.editions import DEFAULT
from airhockey.evaluator.runs.records import AgentProcess, Order, StepTime

Side = Literal["home", "away"]
Winner = Literal["home", "away", "draw"]
Variant = Literal["package", "thesis"]
VARIANTS: dict[Variant, Literal["cannot win", "loses"]] = {"package": "cannot win", "thesis": "loses"}
"""Variants of the rules: what becomes of a player whose penalty is beyond the limit (the package's, and the thesis's 3.3.3)."""
HOME: Side = "home"
AWAY: Side = "away"
SIDES: tuple[Side, Side] = (HOME, AWAY)


def file_name(key: str) -> str:
    """A game's key as the name of a file."""
    return key.replace("/", "_")


class GameOptions(msgspec.Struct, frozen=True, kw_only=True):
    """Everything that a game's course depends on, besides its players, its seed and the versions of the software.

    Attributes:
        steps: Control steps of a game.
        disturbances: Name of a profile or absolute path of a YAML file.
        clock: What the time of `draw_action` is measured with; "cpu" does not mind a busy machine.
        variant: What becomes of a non-deployable player, see `VARIANTS`.
        edition: The year whose rules apply.
        isolate: Where agents live; "auto" is with the evaluator for our own, elsewhere for submissions, as far away as the
            machine can have them.
        patience: Longest time for an answer of an agent that lives elsewhere, in [s].
        real_time: Pace of the steps relative to the robots', for agents that think beside them; 0: as fast as possible.
        agent_seed: As in `records.Options`.
    """

    steps: int = 45000
    disturbances: str = "ideal"
    clock: Literal["wall", "cpu"] = "cpu"
    variant: Variant = "package"
    edition: str = DEFAULT
    isolate: Literal["auto", "none", "process", "sandbox"] = "none"
    patience: float = 60.0
    real_time: float = 0.0
    agent_seed: str | None = None


class GameJob(msgspec.Struct, frozen=True):
    """One game to play.

    Attributes:
        key: Names the game in its run: "0", or "1/alpha-beta".
        home, away: Names of the players.
        home_agent, away_agent: What they are: a name of the registry or the absolute path of a submission.
        seed: Of the game.
        home_order, away_order: Interpolation orders.
        home_python, away_python: Other interpreters for submissions' processes, see `records.Options.python`.
        home_settings, away_settings: Of our own players' controllers, see `records.Options.settings`.
    """

    key: str
    home: str
    away: str
    home_agent: str
    away_agent: str
    seed: int
    home_order: Order = "agent"
    away_order: Order = "agent"
    home_python: str | None = None
    away_python: str | None = None
    home_settings: tuple[str, ...] = ()
    away_settings: tuple[str, ...] = ()

    def swapped(self) -> "GameJob":
        """The same game with the players on each other's side."""
        sides = [(f"home{what}", f"away{what}") for what in ("", "_agent", "_order", "_python", "_settings")]
        there = {one: getattr(self, other) for home, away in sides for one, other in ((home, away), (away, home))}
        return msgspec.structs.replace(self, **there)


class Status(msgspec.Struct, frozen=True, kw_only=True):
    """How a game in progress stands, for a live line.

    Attributes:
        key, home, away: Which game.
        step, steps: Played, and of the whole game.
        score, faults, penalty: Of home and away.
        side: Where the puck is.
        rate: Control steps per second lately.
    """

    key: str
    home: str
    away: str
    step: int
    steps: int
    score: tuple[int, int]
    faults: tuple[int, int]
    penalty: tuple[float, float]
    side: Side
    rate: float


class Event(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """Something that happened in a game.

    Attributes:
        step: Control step, from 1; 0 before the first one.
        what: "serve" (the puck lies on the side of `who`), "goal" (a point for `who`), "fault" (of `who`), "point" (for
            `who`, by the opponent's third fault), "stuck", "out", "held" (`who` took too long and its previous position
            was held), "violation" (`who` got penalty points for this episode of 500 steps; the step is the first that
            violated), "forfeit" (`who` failed).
        who: The side it is about.
        score: After it, home and away.
        why: What made the referee or the judge say so.
        points: Penalty points of a violation; 0 also in journals that are older than this field.
    """

    step: int
    what: str
    who: Side | None = None
    score: tuple[int, int] | None = None
    why: str | None = None
    points: float = 0.0


class PlayerResult(msgspec.Struct, frozen=True, kw_only=True):
    """One player's side of a game.

    Attributes:
        goals: Points by goals.
        points_by_faults: Points by the opponent's faults.
        faults: Its own.
        penalty: Points, summed over the game's episodes of 500 steps.
        deployability: Class of the penalty, at the rate of an official evaluation.
        violations: Constraint name -> number of episodes that violated it; "computation_time" is one of them.
        held: Steps in which its command was held because it took too long.
        computation_time: Of `draw_action`, in [s].
        process: Where it lived.
        failure: Why it forfeited.
    """

    goals: int
    points_by_faults: int
    faults: int
    penalty: float
    deployability: str
    violations: dict[str, int]
    held: int
    computation_time: StepTime
    process: AgentProcess = AgentProcess()
    failure: str | None = None

    @property
    def points(self) -> int:
        """All its points."""
        return self.goals + self.points_by_faults


class GameRecord(msgspec.Struct, frozen=True, kw_only=True):
    """One line of a journal of games; `edition` is the year whose rules applied."""

    job: GameJob
    steps: int
    home: PlayerResult
    away: PlayerResult
    winner: Winner
    events: tuple[Event, ...]
    edition: str = DEFAULT

    @property
    def key(self) -> str:
        """Names the game in its run."""
        return self.job.key

    @property
    def score(self) -> tuple[int, int]:
        """Points of home and away."""
        return self.home.points, self.away.points


def in_order(records: Sequence[GameRecord], keys: Sequence[str]) -> list[GameRecord]:
    """The records of these games, in this order; those not played yet are left out."""
    by_key = {record.key: record for record in records}
    return [by_key[key] for key in keys if key in by_key]
