"""Games on the real simulation, with players and states made for a test."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from arms import with_puck
from numpy.typing import NDArray

from airhockey import envs
from airhockey.agents.hold import HoldAgent
from airhockey.envs.disturbances import load_disturbances
from airhockey.evaluator.isolation import handle
from airhockey.evaluator.isolation.handle import LocalAgent
from airhockey.evaluator.match import MatchFolder, MatchOptions
from airhockey.evaluator.play.game import TIME_LIMIT, Game, GamePlay, GamePlayer, failed_in_game
from airhockey.evaluator.play.seat import Care, Seat
from airhockey.evaluator.runs.game_records import SIDES, Event, GameJob, GameOptions, GameRecord, PlayerResult
from airhockey.evaluator.runs.game_trajectories import read_film
from airhockey.evaluator.runs.manifest import Manifest
from airhockey.evaluator.runs.records import StepTime

Array = NDArray[np.float64]
JOB = GameJob("0", "h", "a", "h", "a", seed=1)
SHORT = 60
"""Control steps."""


class Stander:
    """Stands still, and counts the serves.

    Args:
        order: Interpolation order of its actions.
        think: Called before every action.
    """

    def __init__(self, env: Any, side: int, order: int | None = 3, think: Callable[[], None] = lambda: None) -> None:
        self._hold = HoldAgent(env.env_info, side + 1, interpolation_order=order)
        self.serves, self.think = 0, think

    def episode_start(self) -> None:
        self.serves += 1
        self._hold.episode_start()

    def draw_action(self, observation: Array) -> Array:
        self.think()
        return self._hold.draw_action(observation)


class Clock:
    """A clock that only moves when it is told to."""

    def __init__(self) -> None:
        self.time = 0.0

    def __call__(self) -> float:
        return self.time


def new_game(
    monkeypatch: pytest.MonkeyPatch | None = None, clock: Clock | None = None, orders: Any = (3, 3), **options: Any
) -> GamePlay:
    """A game of two players that stand still, not begun."""
    if monkeypatch is not None and clock is not None:
        monkeypatch.setitem(handle.CLOCKS, "cpu", clock)
    env = envs.make("tournament", orders)
    return seated(GameOptions(**options), env, Stander(env, 0, orders[0]), Stander(env, 1, orders[1]))


def seated(options: GameOptions, env: Any, *agents: Any) -> GamePlay:
    """A game of these agents, not begun."""
    care = Care(options.clock, TIME_LIMIT, failed_in_game)
    seats = [
        Seat(LocalAgent(agent), form, care, side) for agent, form, side in zip(agents, env.formats, SIDES, strict=True)
    ]
    return GamePlay(JOB, options, env, tuple(seats))


def placed(game: GamePlay, *puck: float) -> Array:
    """Serve again, with the puck at (x, y, yaw, ẋ, ẏ, yaw rate); gives the observation."""
    return game.env.reset(state=with_puck(game.env, *puck))


def run(game: GamePlay, observation: Array, steps: int, first: int = 1) -> int:
    """Play until something happens, at most so many steps; gives the step at which it did, or the last one."""
    before = len(game.events)
    game.rollout.observation = observation
    for step in range(first, first + steps):
        game.step()
        if len(game.events) > before:
            return step
    return first + steps - 1


def told(game: GamePlay, *what: str) -> list[tuple[str, str | None]]:
    """Kind and side of the events, of some kinds only if any are given."""
    return [(event.what, event.who) for event in game.events if not what or event.what in what]


def play_one(home: str, away: str, steps: int = 60, seed: int = 1, **options: Any) -> Game:
    """A game of two agents, by name or path."""
    job = GameJob("0", "h", "a", home, away, seed)
    return GamePlayer(GameOptions(steps=steps, **options), load_disturbances("ideal"))(job)


def side(
    goals: int = 0, penalty: float = 0.0, failure: str | None = None, points_by_faults: int = 0, faults: int = 0
) -> PlayerResult:
    """What a player made of a game."""
    return PlayerResult(
        goals=goals,
        points_by_faults=points_by_faults,
        faults=faults,
        penalty=penalty,
        deployability="Deployable",
        violations={},
        held=0,
        computation_time=StepTime(),
        failure=failure,
    )


def course(record: GameRecord) -> Any:
    """Everything about a game but the time that it took."""
    players = [
        (p.goals, p.points_by_faults, p.faults, p.penalty, p.violations, p.failure) for p in (record.home, record.away)
    ]
    return record.job, record.steps, players, record.winner, record.events


def events_of(record: GameRecord, what: str) -> list[Event]:
    return [event for event in record.events if event.what == what]


def film(folder: Path, key: str) -> bytes:
    return read_film(folder / "films" / f"{key.replace('/', '_')}.h5").tobytes()


def short_match(path: Path) -> Path:
    """The folder of a match with one finished game of a little over a second, between two that stand still."""
    options = MatchOptions(home="h", away="a", game=GameOptions(steps=SHORT))
    manifest = Manifest(options=options, profile=load_disturbances("ideal"), versions={}, created="")
    with MatchFolder.create(path, manifest) as folder:
        folder.add(play_one("hold", "hold", SHORT))
    return path
