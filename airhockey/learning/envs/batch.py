"""Many learners' environments, stepped together."""

import pathlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.control.kinematics import spec_of
from airhockey.agents.learned.actions import ACTIONS, new_controls
from airhockey.agents.learned.features import new_sights, width_of
from airhockey.envs.disturbances import Disturbances
from airhockey.envs.vector.environment import Batch, Seeds, VectorEnvironment
from airhockey.errors import ActionError, ConfigurationError, unknown
from airhockey.learning.envs.rewards import REWARDS
from airhockey.learning.envs.stepping import Learner, begin_one, play_many, warm_up

Array = NDArray[np.float64]

OBSERVATIONS = ("features", "raw")


class LearningBatch(VectorEnvironment):
    """N environments of a task with the actions and observations of `airhockey.agents.learned`, and with rewards.

    Args:
        name, num_envs, disturbances, edition_name, threads, seed: See `VectorEnvironment`. One player's tasks only.
        actions: "joints", "tip" or "mallet" (`airhockey.agents.learned.actions`).
        observations: "features" (`airhockey.agents.learned.features`) or "raw", the environment's own.
        reward: "shaped", "progress" or "success", which is 1 for a success at the end of an episode, else 0 (`rewards`).
        repeat: Control steps that an action lasts.
        discount: γ of the shaped reward, for one action: the learner's own.

    Attributes:
        learner: What compiled code plays with.
    """

    def __init__(
        self,
        name: str,
        num_envs: int,
        actions: str = "tip",
        observations: str = "features",
        reward: str = "shaped",
        repeat: int = 2,
        discount: float = 0.99,
        disturbances: str | pathlib.Path | Disturbances = "ideal",
        edition_name: str = "2023",
        threads: int = 1,
        seed: Seeds = None,
    ) -> None:
        for what, given, allowed in (
            ("kind of actions", actions, ACTIONS),
            ("kind of observations", observations, OBSERVATIONS),
            ("reward", reward, REWARDS),
        ):
            if given not in allowed:
                raise unknown(what, given, allowed)
        if isinstance(repeat, bool) or not isinstance(repeat, int) or repeat < 1:
            raise ConfigurationError(
                f"an action cannot last for {repeat!r} control steps; give a whole number from 1 up"
            )
        self._choice = actions, observations, reward, repeat, float(discount)
        super().__init__(name, num_envs, 3, disturbances, edition_name, threads, seed)

    @property
    def horizon(self) -> int:
        """Actions after which an episode is truncated."""
        return -(-self.single.horizon // self.learner.repeat)

    @property
    def observation_width(self) -> int:
        """Length of an observation."""
        return self._features.shape[1] or self.learner.raw.shape[1]

    @property
    def violations(self) -> float:
        """Share of all control steps so far in which a constraint was violated."""
        return float(self.learner.violated.sum() / max(1, self.learner.played.sum()))

    def get_state(self) -> Any:
        """The present moment of all."""
        return super().get_state(), [array.copy() for array in self._remembered()]

    def set_state(self, state: Any) -> None:
        """Go to a moment that this batch, or one made with the same arguments, saved."""
        environments, arrays = state
        super().set_state(environments)
        for array, saved in zip(self._remembered(), arrays, strict=True):
            array[...] = saved

    def new_batch(self) -> Batch:
        """Arrays for `reset` and `step` to write into."""
        batch = super().new_batch()
        kind = np.float32 if self._features.size else np.float64
        seen = [np.zeros((self.num_envs, self.observation_width), kind) for _ in range(2)]
        return batch._replace(observations=seen[0], final_observations=seen[1])

    def _prepare(self) -> None:
        single = self.single
        if single.n_players == 2:
            raise ConfigurationError(
                f"{single.name} has two players; a learner's batch is of a task with one (games: `learning.envs.game`)"
            )
        self._prepare_learner()

    def _prepare_learner(self) -> None:
        single, n = self.single, self.num_envs
        actions, observations, reward, repeat, discount = self._choice
        controls = new_controls(actions, spec_of(single.env_info), n)
        joints = actions == "joints"
        sights = new_sights(single.env_info, joints, n)
        part = single.constraints_slice
        self.learner = Learner(
            repeat, single.horizon, discount, REWARDS.index(reward), controls, sights,
            np.zeros((n, single.true_observation.size)), self._steps, np.zeros(n), np.zeros(n), np.zeros(n),
            np.array([part.start, part.stop]), np.zeros(n, np.int64), np.zeros(n, np.int64),
        )  # fmt: skip
        warm_up(self.fleet, self.learner)
        width = width_of(joints, controls.q.shape[1]) if observations == "features" else 0
        self._features = np.zeros((n, width), np.float32)
        self.action_shape = (controls.q.shape[1],) if joints else (2,)
        self._given = np.zeros((n, *self.action_shape))

    def _take(self, actions: Any) -> None:
        given = np.asarray(actions)
        if given.shape != self._given.shape or given.dtype.kind not in "fiu" or not np.isfinite(given).all():
            raise ActionError(
                f"the actions have shape {given.shape} and type {given.dtype}, or values that are not finite; "
                f"send finite numbers of shape {self._given.shape}, best within [-1, 1]"
            )
        self._given[...] = given

    def _run(self, observations: Any) -> None:
        features = observations if self._features.size else self._features
        self._threads.run(play_many, self.fleet, self.learner, self._given, features, self._counter)
        self._game_steps[:] = self._steps
        if not self._features.size:
            observations[:] = self.learner.raw

    def _reward(self, batch: Batch, score: Any) -> None:
        batch.rewards[:] = self.learner.rewards

    def _first(self, i: int, observation: Array) -> Any:
        self.learner.raw[i] = observation
        begin_one(self.fleet, self.learner, i, self._features[i])
        return self._features[i] if self._features.size else observation

    def _remembered(self) -> list[NDArray[Any]]:
        controls, sights, learner = self.learner.controls, self.learner.sights, self.learner
        commands = [controls.q, controls.velocity, controls.tip, controls.tip_velocity]
        seen = [sights.watches, sights.puck, sights.mallets, sights.recent]
        return [*commands, *seen, learner.raw, learner.potential, learner.best, learner.played, learner.violated]
