"""Live playback: an agent at a task, or two in a game, played while one looks on."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.disturbances import load_disturbances
from airhockey.envs.editions import edition
from airhockey.envs.rendering.marks import TARGETS, Mark, path, target
from airhockey.envs.rendering.scene_view import SceneView
from airhockey.envs.specs import CONTROL_PERIOD
from airhockey.errors import AirHockeyError
from airhockey.evaluator.play import seeding
from airhockey.evaluator.play.episode import EpisodePlayer
from airhockey.evaluator.play.game import GamePlayer
from airhockey.evaluator.play.rollout import Rollout
from airhockey.evaluator.runs.game_records import GameJob, GameOptions
from airhockey.evaluator.runs.records import Job, Options
from airhockey.viewing.caption import Caption
from airhockey.viewing.episodes import ACHIEVED
from airhockey.viewing.games import LOOKED_AT, NEWS_STEPS, latest, moment_of
from airhockey.viewing.playback import predicted_path

Array = NDArray[np.float64]
AHEAD = 0.15
"""How far ahead a commanded motion is drawn, in [s]."""


class LiveTask:
    """The episodes of a run, as they are in the run of the same options.

    Args:
        options: The run's; only its first environment is played.
        episode: Index of the episode to begin with.
    """

    can_go_back = False

    def __init__(self, options: Options, episode: int = 0) -> None:
        self._options, self._name = options, options.environments[0]
        self._player = EpisodePlayer(options, load_disturbances(options.disturbances))
        self.scene_view = SceneView(self._name, options.edition)
        self.begin(episode)

    @property
    def episodes(self) -> int | None:
        """See `Playback`."""
        return None

    def begin(self, episode: int) -> None:
        """See `Playback`."""
        self.episode, self.step = max(episode, 0), 0
        rollout = self._rollout = self._player.open(Job(self._name, self.episode))
        (self._seat,) = rollout.seats
        if self._seat.agent is None:
            raise AirHockeyError(f"there is no agent to watch: {self._seat.failure}")
        self.steps = int(rollout.env.horizon)
        self._now: list[str] = []
        self._violated: set[str] = set()
        rollout.begin()
        self.scene_view.copy_state(rollout.env.simulation.data)

    def advance(self) -> bool:
        """See `Playback`."""
        rollout = self._rollout
        if rollout.over or self.step >= self.steps or not rollout.step():
            return False
        self.step += 1
        values = rollout.info["constraints_value"].items()
        self._now = [name for name, value in values if (np.asarray(value) > 0.0).any()]
        self._violated.update(self._now)
        self.scene_view.copy_state(rollout.env.simulation.data)
        return True

    def seek(self, step: int) -> None:
        """What is live cannot be taken back."""

    def caption(self) -> Caption:
        """See `Playback`."""
        options = self._options
        points = sum(self._rollout.env.edition.penalty_points.get(name, 0.0) for name in self._violated)
        alarm = "violates " + ", ".join(self._now) if self._now else ""
        return Caption(
            f"{self._name}, episode {self.episode}, seed {options.seed}",
            (options.agent.rpartition("/")[2],),
            self.step * CONTROL_PERIOD,
            penalty=(points,),
            phases=(self._seat.phase,),
            news=self._news(),
            alarm=alarm,
        )

    def marks(self) -> list[Mark]:
        """See `Playback`."""
        return marks_of(self.scene_view, self._rollout)

    def close(self) -> None:
        """Tell the agent that it is over."""
        self._player.close()

    def _news(self) -> str:
        """How it ended, once it has."""
        if self._seat.failure is not None:
            return f"the agent failed: {self._seat.failure}"
        if not self._rollout.over and self.step < self.steps:
            return ""
        _, achieved = ACHIEVED[edition(self._options.edition).environment(self._name).kind]
        return achieved if self._rollout.info["success"] else "not achieved"


class LiveGame:
    """Games of two agents, as they are in the match of the same options.

    Args:
        home, away: Names of the registry or paths.
        options: How each is played.
        seed: The match's.
        episode: Number of the game to begin with.
    """

    can_go_back = False

    def __init__(self, home: str, away: str, options: GameOptions, seed: int, episode: int = 0) -> None:
        self._agents, self._options, self._seed = (home, away), options, seed
        self._player = GamePlayer(options, load_disturbances(options.disturbances))
        self._game: Any = None
        self.scene_view = SceneView("tournament", options.edition)
        self.begin(episode)

    @property
    def episodes(self) -> int | None:
        """See `Playback`."""
        return None

    def begin(self, episode: int) -> None:
        """See `Playback`."""
        self.episode, self.step, self.steps = max(episode, 0), 0, self._options.steps
        key = str(self.episode)
        self.close()
        home, away = self._agents
        names = home.rpartition("/")[2], away.rpartition("/")[2]
        job = GameJob(key, *names, home, away, seeding.game_seed(self._seed, key))
        self._game = self._player.open(job)
        self._names = names
        failed = [seat.failure for seat in self._game.seats if seat.failure]
        if failed:
            raise AirHockeyError(f"there is no game to watch: {failed[0]}")
        self._game.begin()
        self.scene_view.copy_state(self._game.env.simulation.data)

    def advance(self) -> bool:
        """See `Playback`."""
        if self._game.over:
            return False
        self._game.step()
        self.step = self._game.rollout.steps
        self.scene_view.copy_state(self._game.env.simulation.data)
        return True

    def seek(self, step: int) -> None:
        """What is live cannot be taken back."""

    def close(self) -> None:
        """Tell the players that the game is over."""
        for seat in self._game.seats if self._game else ():
            seat.stop()

    def caption(self) -> Caption:
        """See `Playback`."""
        game = self._game
        home, away = game.penalties
        recent = [
            moment_of(event, self._names) for event in game.events[-LOOKED_AT:] if self.step - event.step < NEWS_STEPS
        ]
        caption = Caption(
            f"game {self.episode}, seed {self._seed}",
            self._names,
            self.step * CONTROL_PERIOD,
            (game.env.score[0], game.env.score[1]),
            (game.env.faults[0], game.env.faults[1]),
            (home.count.points, away.count.points),
            phases=tuple(seat.phase for seat in game.seats),
            news=latest(recent),
        )
        violated = [
            f"{name} violates {constraint}"
            for name, values in zip(self._names, game.env.constraint_values, strict=True)
            for constraint, part in game.env.constraint_slices.items()
            if self.step and (values[part] > 0.0).any()
        ]
        failures = [
            f"{name} failed: {seat.failure}" for name, seat in zip(self._names, game.seats, strict=True) if seat.failure
        ]
        return replace(caption, alarm="; ".join(failures or violated))

    def marks(self) -> list[Mark]:
        """See `Playback`."""
        return marks_of(self.scene_view, self._game.rollout)


def marks_of(scene_view: SceneView, rollout: Rollout) -> list[Mark]:
    """Where the puck will go, and where each agent wants its mallet once it has acted."""
    base = rollout.env.base_observation
    marks = predicted_path(base[:3], base[3:6])
    for k, seat in enumerate(rollout.seats if rollout.steps else ()):
        marks += mallet_target(scene_view, k, seat.target, seat.action)
    return marks


def commanded(action: Any) -> tuple[Array, Array]:
    """Joint position and velocity that an action leads to, whatever its order; at rest where it names no velocity.

    Args:
        action: As an agent gives it: (n,), (2, n), (3, n) or the set-points (20, 3, n).

    Returns:
        In [rad] and [rad/s]. Shapes (n,), (n,).
    """
    array = np.asarray(action, dtype=np.float64)
    if array.ndim == 3:
        array = array[-1]
    return (array, np.zeros_like(array)) if array.ndim == 1 else (array[0], array[1])


def mallet_target(scene_view: SceneView, player: int, wanted: Any, action: Any) -> list[Mark]:
    """Where an agent wants its mallet, and a line there from where it commands it now.

    Where it does not say, that is where the motion that it commands would lead within `AHEAD`.

    Args:
        scene_view: Of the game.
        player: 0 or 1.
        wanted: What it says: x and y on the table, seen from its own side, in [m]; None where it says nothing.
        action: What it sent last.
    """
    position, velocity = commanded(action)
    tip = scene_view.tip_position(player, position)[:2]
    if wanted is None:
        wanted = scene_view.tip_position(player, position + AHEAD * velocity)[:2]
    else:
        wanted = np.asarray(wanted, dtype=np.float64)[:2] * (1.0 if player == 0 else -1.0)
    return [target(wanted.tolist(), player), *path(np.stack([tip, wanted]), TARGETS[player], fades=False)]
