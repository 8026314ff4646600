"""Many environments of one kind, stepped together; each is to the bit what it would be alone."""

import pathlib
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.copying import Copyable
from airhockey.envs.disturbances import Disturbances
from airhockey.envs.environment import Environment, Order, Seed, State
from airhockey.envs.kernel.control_step import DONE
from airhockey.envs.specs import SUBSTEPS
from airhockey.envs.tasks import verdicts
from airhockey.envs.vector.perception import give_back, new_senses, take_over
from airhockey.envs.vector.stepping import KINDS, Fleet, step_many
from airhockey.envs.vector.threads import Threads
from airhockey.errors import ActionError, ConfigurationError, SimulationError

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Seeds = int | Sequence[Seed] | None


class Batch(NamedTuple):
    """What a step of N environments gives. The arrays are the caller's: nobody else writes to them.

    Attributes:
        observations: In the tournament both players', one after the other. Where an episode (a serve, a game) ended, the
            first one of the next. Shape (N, D).
        rewards: 1 where an episode ended with success, else 0; in the tournament the points that either player won in this
            step less those of the other, shape (N, 2). Shape (N,).
        terminated: The referee ended the episode, or in the tournament the serve. Shape (N,).
        truncated: The horizon ended the episode, or in the tournament the game. Shape (N,).
        success: Whether the task would count as a success if it ended after this step. Shape (N,).
        verdicts: The referee's (`airhockey.envs.tasks.verdicts`). Shape (N,).
        constraints: Values of this step, violated where positive; in the tournament both players'. Shape (N, K) or (N, 2 K).
        final_observations: The last one of the episode, where one ended; elsewhere as `observations`. Shape (N, D).
    """

    observations: Array
    rewards: Array
    terminated: Flags
    truncated: Flags
    success: Flags
    verdicts: NDArray[np.int64]
    constraints: Array
    final_observations: Array


class VectorEnvironment(Copyable):
    """N environments that are stepped by threads within one compiled call.

    Environment i is to the bit an `airhockey.envs.Environment` that was reset with seed i of `reset`, and then, at the end of
    every episode, without a seed: for any N and any number of threads. In the tournament a serve that ended is followed by
    the next one, and a game by a new one.

    Args:
        name, interpolation_order, disturbances, edition_name: See `airhockey.envs.Environment`; players' orders must be equal.
        num_envs: N.
        threads: That step them; best one for each core.
        seed: See `reset`.

    Attributes:
        num_envs: N.
        action_shape: Of one environment's action: (n,), (2, n) and so on by the order; (2, …) in the tournament.
        fleet: What compiled code steps.
        single: An environment of the same kind, for what is the same in all: `env_info`, `formats`, `horizon`. Not stepped.
    """

    def __init__(
        self,
        name: str,
        num_envs: int,
        interpolation_order: Order = 3,
        disturbances: str | pathlib.Path | Disturbances = "ideal",
        edition_name: str = "2023",
        threads: int = 1,
        seed: Seeds = None,
    ) -> None:
        if isinstance(num_envs, bool) or not isinstance(num_envs, (int, np.integer)) or num_envs < 1:
            raise ConfigurationError(f"{num_envs!r} environments: it must be a whole number from 1 up")
        if isinstance(interpolation_order, tuple):
            raise ConfigurationError(f"a batch has one interpolation order for all players, not {interpolation_order}")
        self.num_envs = int(num_envs)
        self.single = Environment(name, interpolation_order, disturbances, edition_name)
        self._make(threads)
        self.reset(np.random.SeedSequence().spawn(self.num_envs) if seed is None else seed)

    def __getstate__(self) -> dict[str, Any]:
        """All but what compiled code and threads work with, and the present moment."""
        kept = {name: value for name, value in self.__dict__.items() if name not in self._made}
        return kept | {"_now": (self._threads.count, self.get_state())}

    def __setstate__(self, state: dict[str, Any]) -> None:
        threads, moment = state["_now"]
        self.__dict__.update({name: value for name, value in state.items() if name != "_now"})
        self._make(threads)
        self.set_state(moment)

    def _make(self, threads: int) -> None:
        """Make what compiled code and threads work with; `_made` are the names of these attributes."""
        before, n, single = set(self.__dict__), self.num_envs, self.single
        self._threads = Threads(threads, most=n)
        self._environments = [single.copy() for _ in range(n)]
        form, robots, joints = single.formats[0], single.n_agents, single.simulation.robot.n_joints
        self.action_shape = form.shape if single.n_players == 1 else (2, *form.shape)
        rows = max(form.rows, 2 * (robots > single.n_players))
        shaken = single.disturbances.torque > 0.0
        self.fleet = Fleet(
            KINDS.index(single.edition.environment(single.name).kind),
            np.zeros(n, single.simulation.memory.dtype),
            np.zeros(n, single.referee.dtype),
            np.zeros((n, robots, rows, joints)),
            np.zeros((n, SUBSTEPS if shaken else 0, robots, joints)),
            np.zeros((n, single.simulation.flat.size)),
            single.observation_slice.start,
            np.zeros(n, np.int64),
            np.zeros(n, np.int64),
            *new_senses(single, n),
        )
        self._slots = self.fleet.actions[:, : single.n_players, : form.rows]
        self._counter = np.zeros(1, np.int64)
        self._steps, self._game_steps = np.zeros(n, np.int64), np.zeros(n, np.int64)
        for i, env in enumerate(self._environments):
            env.move_into(self.fleet.memories[i : i + 1], self.fleet.referees[i : i + 1], self.fleet.left[i])
        self._prepare()
        self._made = {*self.__dict__, "_made"} - before

    @property
    def horizon(self) -> int:
        """Steps after which an episode is truncated, in the tournament a game."""
        return self.single.horizon

    @property
    def constraint_slices(self) -> dict[str, slice]:
        """Where each constraint's values stand in a row of `Batch.constraints`; in the tournament, those of player 1."""
        return self.single.constraint_slices

    def new_batch(self) -> Batch:
        """Arrays for `reset` and `step` to write into."""
        n, players = self.num_envs, self.single.n_players
        width, count = self.single.true_observation.size, self.single.constraint_values.size
        terminated, truncated, success = (np.zeros(n, np.bool_) for _ in range(3))
        rewards = np.zeros(n if players == 1 else (n, players))
        seen, final = np.zeros((n, width)), np.zeros((n, width))
        told, values = np.zeros(n, np.int64), np.zeros((n, count))
        return Batch(seen, rewards, terminated, truncated, success, told, values, final)

    def reset(self, seed: Seeds = None, into: Batch | None = None, which: Flags | None = None) -> Batch:
        """Begin an episode, or in the tournament a game.

        Args:
            seed: An integer s gives environment i the seed s + i, which means there what it means to `Environment.reset`; or
                one seed for each; without, their random streams go on.
            into: Arrays to write the observations into; new ones by default.
            which: The environments to reset; all by default. Shape (N,).
        """
        batch = self.new_batch() if into is None else into
        seeds = self._seeds(seed)
        for i in range(self.num_envs) if which is None else np.flatnonzero(which):
            if seeds[i] is None and self.single.n_players == 2:
                self._environments[i].new_game()
            self._begin(int(i), seeds[i], batch.observations)
            self._game_steps[i] = 0
        batch.final_observations[:] = batch.observations
        return batch

    def step(self, actions: Any, into: Batch | None = None) -> Batch:
        """Advance all by one control step of 0.02 s; where an episode ended, the next one has begun.

        Args:
            actions: Shape (N, *action_shape).
            into: Arrays to write into; new ones by default.

        Raises:
            ActionError: Of the wrong shape or type, with nothing simulated; or an environment's is not finite.
            SimulationError: The engine warned.
        """
        batch = self.new_batch() if into is None else into
        self._take(actions)
        before = self.fleet.referees["score"].copy() if self.single.n_players == 2 else None
        self._simulate(batch.observations)
        self._read(batch)
        self._reward(batch, before)
        self._go_on(batch)
        return batch

    def environment(self, index: int) -> Environment:
        """A copy of one of the environments as it is now, to look at or to play on with."""
        return self._synced(index).copy()

    def get_state(self) -> list[tuple[State, int]]:
        """The present moment of all; see `Environment.get_state`."""
        return [(self._synced(i).get_state(), int(self._game_steps[i])) for i in range(self.num_envs)]

    def set_state(self, state: list[tuple[State, int]]) -> None:
        """Go to a moment that this batch, or one made with the same arguments, saved."""
        for i, ((moment, steps), env) in enumerate(zip(state, self._environments, strict=True)):
            env.set_state(moment)
            self._keep(i)
            self._steps[i], self._game_steps[i] = env.step_count, steps
            self.fleet.verdicts[i] = env.verdict + (verdicts.SUCCESS if env.succeeded else 0)

    def close(self) -> None:
        """End the threads."""
        self._threads.close()

    def _take(self, actions: Any) -> None:
        given = np.asarray(actions)
        wanted = (self.num_envs, *self.action_shape)
        if given.shape != wanted or given.dtype.kind not in "fiu":
            raise ActionError(
                f"the actions have shape {given.shape} and type {given.dtype}; send numbers of shape {wanted}"
            )
        self._slots[...] = given.reshape(self._slots.shape)

    def _prepare(self) -> None:
        """Whatever else a kind of batch needs, before its first episode begins."""

    def _run(self, observations: Any) -> None:
        """Step all, and write what they see."""
        self._steps += 1
        self._game_steps += 1
        self._threads.run(step_many, self.fleet, observations, self._counter)

    def _reward(self, batch: Batch, score: Any) -> None:
        """Write the rewards; `score` is that of the games before the step. Shape (N, 2)."""
        if score is None:
            np.logical_and(batch.success, batch.terminated | batch.truncated, out=batch.rewards, casting="unsafe")
            return
        gained = self.fleet.referees["score"] - score
        batch.rewards[:, 0] = gained[:, 0] - gained[:, 1]
        batch.rewards[:, 1] = -batch.rewards[:, 0]

    def _first(self, i: int, observation: Array) -> Any:
        """What is seen at the beginning of an episode."""
        return observation

    def _simulate(self, observations: Any) -> None:
        self._counter[0] = 0
        self._run(observations)
        if self.fleet.codes.any():
            first = int(np.flatnonzero(self.fleet.codes != DONE)[0])
            simulation, step = self._environments[first].simulation, int(self._steps[first])
            try:
                simulation.complain(int(self.fleet.codes[first]), self.fleet.actions[first], step)
            except (ActionError, SimulationError) as error:
                raise type(error)(f"environment {first}, {error}") from None
            finally:
                self._keep(first)

    def _read(self, batch: Batch) -> None:
        """Copy what the step left, and see whose episode is over."""
        single = self.single
        batch.final_observations[:] = batch.observations
        batch.constraints[:] = self.fleet.left[:, single.constraints_slice]
        batch.verdicts[:] = self.fleet.verdicts & ~verdicts.SUCCESS
        np.greater_equal(self.fleet.verdicts, verdicts.SUCCESS, out=batch.success)
        np.not_equal(batch.verdicts, verdicts.GOING_ON, out=batch.terminated)
        np.greater_equal(self._game_steps, single.horizon, out=batch.truncated)
        if single.n_players == 1:
            batch.truncated[batch.terminated] = False

    def _go_on(self, batch: Batch) -> None:
        """The next episode, serve or game, where one ended."""
        for i in np.flatnonzero(batch.terminated | batch.truncated):
            if batch.truncated[i] and self.single.n_players == 2:
                self._environments[i].new_game()
            self._begin(int(i), None, batch.observations)
            if batch.truncated[i] or self.single.n_players == 1:
                self._game_steps[i] = 0

    def _begin(self, i: int, seed: Seed, observations: Any) -> None:
        observation = self._environments[i].reset(seed)
        self._keep(i)
        self._steps[i], self.fleet.verdicts[i] = 0, verdicts.GOING_ON
        observations[i] = self._first(i, observation)

    def _keep(self, i: int) -> None:
        """After a reset: its streams are perhaps others, and its array of readings is a new one; have it write here again."""
        take_over(self.fleet.senses, i, self._environments[i])
        simulation = self._environments[i].simulation
        self.fleet.left[i], simulation.flat = simulation.flat, self.fleet.left[i]

    def _synced(self, i: int) -> Environment:
        env, verdict = self._environments[i], int(self.fleet.verdicts[i])
        give_back(self.fleet.senses, i, env)
        env.step_count = int(self._steps[i])
        env.verdict, env.succeeded = verdict & ~verdicts.SUCCESS, verdict >= verdicts.SUCCESS
        return env

    def _seeds(self, seed: Seeds) -> list[Seed]:
        if seed is None or isinstance(seed, (int, np.integer)):
            return [None if seed is None else (int(seed) + i) % 2**32 for i in range(self.num_envs)]
        if len(seed) != self.num_envs:
            raise ConfigurationError(
                f"{len(seed)} seeds for {self.num_envs} environments; give one each, or one number"
            )
        return [s if s is None or isinstance(s, np.random.SeedSequence) else int(s) % 2**32 for s in seed]
