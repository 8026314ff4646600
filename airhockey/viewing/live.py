"""Live shows: an agent at a task, or two in a game, played while one looks on."""

import contextlib
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.disturbances import load_disturbances
from airhockey.envs.specs import CONTROL_PERIOD
from airhockey.errors import AirHockeyError
from airhockey.evaluator.isolation.handle import AgentHandle
from airhockey.evaluator.play import seeding
from airhockey.evaluator.play.episode import agent_failures, describe
from airhockey.evaluator.play.episode_player import Player, Setting
from airhockey.evaluator.play.game import GamePlay
from airhockey.evaluator.play.game_player import GamePlayer
from airhockey.evaluator.play.watchdog import Watch
from airhockey.evaluator.runs.game_records import SIDES, GameJob, GameOptions
from airhockey.evaluator.runs.records import Options
from airhockey.viewing.caption import Caption
from airhockey.viewing.episodes import ACHIEVED
from airhockey.viewing.games import LOOKED_AT, NEWS_STEPS, news_of, told
from airhockey.viewing.marks import TARGETS, Mark, path, target
from airhockey.viewing.playback import predicted_path
from airhockey.viewing.scene_view import Stage

Array = NDArray[np.float64]
AHEAD = 0.15
"""How far ahead a commanded motion is drawn, in [s]."""


class OpenPlayer(Player):
    """A player whose setting can be used step by step."""

    def setting(self, env: str) -> Setting:
        """The environment with its agent, built on first use or after a failure."""
        return self._setting_for(env)

    def seed_agent(self, setting: Setting, index: int) -> None:
        """As before an episode of a run."""
        seed = seeding.seed_of(self.options.seed, setting.name, index, seeding.AGENT)
        seeding.seed_global_generators(seed)
        if isinstance(setting.agent, AgentHandle):
            setting.agent.seed(seed)


class LiveTask:
    """The episodes of a run, as they are in the run of the same options.

    Args:
        options: The run's; only its first environment is played.
        episode: Index of the episode to begin with.
    """

    can_go_back = False

    def __init__(self, options: Options, episode: int = 0) -> None:
        self._options, self._name = options, options.environments[0]
        self._player = OpenPlayer(options, load_disturbances(options.disturbances))
        self.stage = Stage(self._name, options.edition)
        self.begin(episode)

    @property
    def episodes(self) -> int | None:
        """See `Show`."""
        return None

    def begin(self, episode: int) -> None:
        """See `Show`."""
        setting = self._setting = self._player.setting(self._name)
        if setting.failure is not None:
            raise AirHockeyError(f"there is no agent to watch: {setting.failure}")
        self.episode, self.step, self.steps = max(episode, 0), 0, int(setting.env.horizon)
        self._over, self._news = False, ""
        self._now: list[str] = []
        self._violated: set[str] = set()
        self._player.seed_agent(setting, self.episode)
        try:
            setting.agent.episode_start()
        except agent_failures() as failure:
            self._fail(failure)
        seed = seeding.seed_of(self._options.seed, self._name, self.episode, seeding.ENVIRONMENT)
        self._observation = setting.env.reset(seed=seed)
        self._action: Any = None
        self.stage.copy_state(setting.env.simulation.data)

    def advance(self) -> bool:
        """See `Show`."""
        if self._over:
            return False
        env, agent = self._setting.env, self._setting.agent
        try:
            for preprocessor in getattr(agent, "preprocessors", ()):
                self._observation = preprocessor(self._observation)
            action = agent.draw_action(self._observation)
            self._observation, _, self._over, info = env.step(action)
        except agent_failures() as failure:
            self._fail(failure)
            return False
        self.step += 1
        self._action = action
        self._note(env, info)
        self.stage.copy_state(env.simulation.data)
        return True

    def seek(self, step: int) -> None:
        """What is live cannot be taken back."""

    def caption(self) -> Caption:
        """See `Show`."""
        env, options = self._setting.env, self._options
        points = sum(env.edition.penalty_points.get(name, 0.0) for name in self._violated)
        alarm = "violates " + ", ".join(self._now) if self._now else ""
        return Caption(
            f"{self._name}, episode {self.episode}, seed {options.seed}",
            (options.agent.rpartition("/")[2],),
            self.step * CONTROL_PERIOD,
            penalty=(points,),
            phases=(str(getattr(self._setting.agent, "phase", "")),),
            news=self._news,
            alarm=alarm,
        )

    def marks(self) -> list[Mark]:
        """See `Show`."""
        base = self._setting.env.base_observation
        return predicted_path(base[:3], base[3:6]) + mallet_target(self.stage, 0, self._setting.agent, self._action)

    def close(self) -> None:
        """Tell the agent that it is over."""
        self._player.close()

    def _note(self, env: Any, info: Any) -> None:
        self._now = [name for name, value in info["constraints_value"].items() if (np.asarray(value) > 0.0).any()]
        self._violated.update(self._now)
        self._over = self._over or self.step >= self.steps
        if self._over:
            _, achieved = ACHIEVED[self._name.rpartition("-")[2]]
            self._news = achieved if info["success"] else "not achieved"

    def _fail(self, failure: BaseException) -> None:
        self._over, self._news = True, f"the agent failed: {describe(failure)}"


class OpenGamePlayer(GamePlayer):
    """A player of games that hands out a game before it is played."""

    def open(self, job: GameJob) -> GamePlay:
        """The players and the table, ready to begin."""
        watch = Watch()
        env, builds = self._build(job, watch)
        agents, failures = zip(*builds, strict=True)
        return GamePlay(job, self.options, env, agents, failures, watch=watch)


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
        self._player = OpenGamePlayer(options, load_disturbances(options.disturbances))
        self._game: Any = None
        self.stage = Stage("tournament", options.edition)
        self.begin(episode)

    @property
    def episodes(self) -> int | None:
        """See `Show`."""
        return None

    def begin(self, episode: int) -> None:
        """See `Show`."""
        self.episode, self.step, self.steps = max(episode, 0), 0, self._options.steps
        key = str(self.episode)
        self.close()
        home, away = self._agents
        names = home.rpartition("/")[2], away.rpartition("/")[2]
        job = GameJob(key, *names, home, away, seeding.game_seed(self._seed, key))
        self._game = self._player.open(job)
        self._names = names
        failed = [competitor.failure for competitor in self._game.competitors if competitor.failure]
        if failed:
            raise AirHockeyError(f"there is no game to watch: {failed[0]}")
        self._observation = self._game.begin()
        self.stage.copy_state(self._game.env.simulation.data)

    def advance(self) -> bool:
        """See `Show`."""
        failed = [competitor for competitor in self._game.competitors if competitor.failure is not None]
        if self.step >= self.steps or failed:
            return False
        self.step += 1
        self._observation = self._game.step(self._observation, self.step)
        self.stage.copy_state(self._game.env.simulation.data)
        return True

    def seek(self, step: int) -> None:
        """What is live cannot be taken back."""

    def close(self) -> None:
        """Tell the players that the game is over."""
        for agent in self._game.agents if self._game else ():
            stop = getattr(agent, "stop", None)
            if stop is not None:
                with contextlib.suppress(*agent_failures()):
                    stop()

    def caption(self) -> Caption:
        """See `Show`."""
        game = self._game
        home, away = game.competitors
        recent = [told(event, self._names) for event in game.events[-LOOKED_AT:] if self.step - event.step < NEWS_STEPS]
        caption = Caption(
            f"game {self.episode}, seed {self._seed}",
            self._names,
            self.step * CONTROL_PERIOD,
            (game.env.score[0], game.env.score[1]),
            (game.env.faults[0], game.env.faults[1]),
            (home.penalties.points, away.penalties.points),
            phases=tuple(str(getattr(competitor.agent, "phase", "")) for competitor in game.competitors),
            news=news_of(recent),
        )
        violated = [
            f"{name} violates {constraint}"
            for name, values in zip(self._names, game.env.constraint_values, strict=True)
            for constraint, part in game.env.constraint_slices.items()
            if self.step and (values[part] > 0.0).any()
        ]
        failures = [
            f"{name} failed: {competitor.failure}"
            for name, competitor in zip(self._names, game.competitors, strict=True)
            if competitor.failure
        ]
        return replace(caption, alarm="; ".join(failures or violated))

    def marks(self) -> list[Mark]:
        """See `Show`."""
        game = self._game
        base = game.env.base_observation
        marks = predicted_path(base[:3], base[3:6])
        for k in range(len(SIDES)):
            action = game.competitors[k].action if self.step else None
            marks += mallet_target(self.stage, k, game.competitors[k].agent, action)
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


def mallet_target(stage: Stage, player: int, agent: Any, action: Any) -> list[Mark]:
    """Where an agent wants its mallet, and a line there from where it commands it now.

    That is what the agent says as `target` (x and y on the table, seen from its own side), or else where the motion that it
    commands would lead within `AHEAD`.

    Args:
        stage: Of the game.
        player: 0 or 1.
        agent: It may have `target`.
        action: What it sent last; None before the first step.
    """
    if action is None:
        return []
    position, velocity = commanded(action)
    tip = stage.tip_position(player, position)[:2]
    wanted = getattr(agent, "target", None)
    if wanted is None:
        wanted = stage.tip_position(player, position + AHEAD * velocity)[:2]
    else:
        wanted = np.asarray(wanted, dtype=np.float64)[:2] * (1.0 if player == 0 else -1.0)
    return [target(wanted.tolist(), player), *path(np.stack([tip, wanted]), TARGETS[player], fades=False)]
