"""The challenge environment: a task or a game on the simulation, as the evaluator, the trainers and the adapters use it."""

import copy
import pathlib
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.actions import FLOAT, ActionFormat
from airhockey.envs.constraints import constraint_slices
from airhockey.envs.copying import Copyable
from airhockey.envs.disturbances import Disturbances, Mismatch, load_disturbances
from airhockey.envs.editions import ROBOTS, Edition, edition
from airhockey.envs.info import make_env_info
from airhockey.envs.kernel.memory import bytes_from, pack, view
from airhockey.envs.kernel.opponent import ORDER as OPPONENT_ORDER
from airhockey.envs.perception import Perception
from airhockey.envs.plant_mismatch import PlantMismatch
from airhockey.envs.random_stream import Stream
from airhockey.envs.simulation import Simulation, SimulationState
from airhockey.envs.specs import CONTROL_PERIOD, SUBSTEPS, TABLE
from airhockey.envs.tasks import task, verdicts
from airhockey.envs.tasks.game import AWAY_SERVES, HOME_SERVES, Game, new_game
from airhockey.errors import ActionError, ConfigurationError

Array = NDArray[np.float64]
Seed = int | np.random.SeedSequence | None
Order = int | None


class Episode(NamedTuple):
    """What a reset decides: the streams' states then, and the plant.

    Attributes:
        start: State of the generator of starts and serves, after the latest draw.
        streams: See `State.streams`, where they do not go on at every step; else None.
        plant: The model's perturbed fields.
    """

    start: Any
    streams: Any
    plant: Any


class State(NamedTuple):
    """A moment of an environment, which `Environment.set_state` goes back to: numbers, bytes and arrays, to be kept or pickled.

    Attributes:
        made_for: Name, interpolation orders, edition and disturbances of the environment.
        simulation: Physics, controllers, filters, the opponent, the latest readings.
        game: Score, faults, sides, timer.
        progress: Steps, verdict, success.
        episode: What the latest reset decided.
        streams: States of the random stream of the plant and of each player's perception, where they go on at every step.
    """

    made_for: tuple[Any, ...]
    simulation: SimulationState
    game: bytes
    progress: tuple[int, int, bool]
    episode: Episode
    streams: Any


class Environment(Copyable):
    """One of the challenge's environments.

    To plan, save a moment and go back to it as often as needed, `state = env.get_state()` and `env.set_state(state)`, or
    work on a copy, `env.copy()`; pickle and `copy.deepcopy` make such copies, too. Either has the same future to the bit:
    serve, score, timers, filters, delays, plant and random streams are part of it. A copy shares the original's model where
    that is the same in all episodes.

    An action is what the interpolation order asks of one robot, or a pair of them in the tournament. An observation, in the
    robot frame of the player:

    | index (n joints) | quantity | unit |
    |---|---|---|
    | 0–2 | puck x, y, yaw | m, m, rad |
    | 3–5 | puck velocity | m/s, m/s, rad/s |
    | 6 … 6+n−1 | joint positions | rad |
    | 6+n … 6+2n−1 | joint velocities, filtered | rad/s |
    | 6+2n … 8+2n | opponent's rod tip x, y, z (scenes with two robots) | m |

    Args:
        name: "3dof-hit", "3dof-defend", "7dof-hit", "7dof-defend", "7dof-prepare" or "tournament"; in the edition of 2025
            "hit", "hit_single", "defend", "prepare" or "tournament" (or "7dof-hit", "7dof-hit_single" and so on).
        interpolation_order: 1, 2, 3, 4, 5, -1 or None; in the tournament also a pair of them.
        disturbances: A profile's name, the path of a YAML file, or a profile.
        edition_name: The year whose rules apply.
        visual: Draw the arms' links, for viewers; physics is the same.

    Attributes:
        name: The environment's name in its edition.
        env_info: What agents are built with.
        horizon: Control steps in an episode.
        dt: Length of a control step, in [s].
        n_agents: Number of robots in the scene.
        n_players: Number of robots that take actions.
        task: The task's page: its referee, start and reward (`airhockey.envs.tasks`).
        game: What the referee remembers of a game: score, faults, sides and timer.
        verdict: The referee's, of the latest step (`airhockey.envs.tasks.verdicts`).
        succeeded: Whether the task would count as a success if it ended after the latest step.
        perceptions: Each player's.
        plant_random: The stream of the plant: its mismatch, and the torques that are added to the motors'.
        torque_deviation: Of those torques, in [N·m]. Shape (n,).
        observation_slice, constraints_slice: Where the players' true observations and constraint values stand in
            `simulation.flat`.
    """

    dt = CONTROL_PERIOD

    def __init__(
        self,
        name: str,
        interpolation_order: Order | tuple[Order, Order] = 3,
        disturbances: str | pathlib.Path | Disturbances = "ideal",
        edition_name: str = "2023",
        visual: bool = False,
    ) -> None:
        self.edition: Edition = edition(edition_name)
        rules = self.edition.environment(name)
        robot = ROBOTS[rules.robot]
        self.name = name = self.edition.official_name(name)
        self.disturbances = load_disturbances(disturbances)
        self.n_agents = rules.robots
        self.task = task(rules.kind)
        self.n_players = self.task.players
        self.horizon = self.edition.horizon.game if self._is_game else self.edition.horizon.task
        given = interpolation_order
        orders = given if isinstance(given, tuple) else (given,) * self.n_players
        if len(orders) != self.n_players:
            raise ConfigurationError(f"{name} has {self.n_players} player(s), but got interpolation orders {orders}")
        self.formats = [ActionFormat(order, robot.n_joints) for order in orders]
        self._starts = self.edition.starts_of(name)
        codes = [form.code for form in self.formats] + [OPPONENT_ORDER] * (self.n_agents - self.n_players)
        self.simulation = Simulation(
            robot,
            rules.robots,
            np.array(codes, dtype=np.int64),
            rules.opponent == "figure_of_eight",
            visual,
            self.edition.scene,
        )
        self.env_info = make_env_info(name, self.simulation, self.edition, self.horizon)
        self.constraint_slices = constraint_slices(self.simulation.arm)
        self._referee = pack(_referee_rules(self.edition), new_game())
        rows = max([form.rows for form in self.formats] + [2] * (self.n_agents - self.n_players))
        self._action = np.zeros((self.n_agents, rows, robot.n_joints))
        self._make_views()
        self._make_slices()
        self._no_noise = np.zeros((0, self.n_agents, robot.n_joints))
        self.torque_deviation = self.disturbances.torque * self.simulation.arm.torque_limit
        self._mismatch = PlantMismatch(self.simulation.model, robot, self.n_agents)
        self._blurred = self.disturbances.blurs_observations
        self.perceptions = [Perception(self.disturbances, robot.n_joints) for _ in range(self.n_players)]
        self._start_is_own = True
        self._episode: Episode | None = None
        self._draws_at_steps = self._blurred or self.disturbances.torque > 0.0
        self._made_for = (name, tuple(orders), edition_name, self.disturbances)
        self._start_random = np.random.RandomState(0)
        self._perception_randoms: list[np.random.Generator] = []
        self._seed_streams(np.random.SeedSequence())
        self.reset()

    @property
    def base_observation(self) -> Array:
        """The true state in world coordinates, as `reset(state=…)` accepts it: puck, joints, opponent, per robot."""
        return self.simulation.flat[self._base].copy()

    @property
    def true_observation(self) -> Array:
        """The observation without disturbances, which judging uses."""
        return self.simulation.flat[self.observation_slice].copy()

    @property
    def constraint_values(self) -> Array:
        """Constraint values of the latest step, violated where positive; shape (K,), in the tournament (2, K)."""
        values = self.simulation.flat[self.constraints_slice]
        return values.reshape((2, -1)) if self.n_players == 2 else values

    @property
    def score(self) -> list[int]:
        """Points of player 1 and player 2 in a game."""
        return [int(points) for points in self.game.score]

    @property
    def faults(self) -> list[int]:
        """Faults of player 1 and player 2 in a game."""
        return [int(count) for count in self.game.faults]

    @property
    def _is_game(self) -> bool:
        return self.n_players == 2

    def reset(
        self, seed: Seed = None, state: Array | None = None, start_random: np.random.RandomState | None = None
    ) -> Array:
        """Begin an episode, or in the tournament a game (with a seed) or its next serve (without).

        Args:
            seed: Decides the start and every disturbance. An integer s gives the official start of `np.random.seed(s)`.
                Without one the present random streams go on.
            state: A base observation; joints and puck are put there after the start was drawn.
            start_random: Draw the start from this generator instead of the environment's own.

        Returns:
            The observation.
        """
        if seed is not None:
            self._seed_streams(seed)
        elif self._is_game:
            self.game.side[0] = 0
        if start_random is not None:
            self.draw_starts_from(start_random)
        self._episode = None
        self._mismatch.apply(self.disturbances.mismatch, self.plant_random)
        puck = self._draw_puck()
        if state is None:
            self.simulation.reset(*puck)
        else:
            self._restore(np.asarray(state, dtype=np.float64))
        for perception, random in zip(self.perceptions, self._perception_randoms, strict=True):
            perception.reset(random)
        self.step_count, self.verdict, self.succeeded = 0, verdicts.GOING_ON, False
        return self._observe()

    def step(self, action: Any) -> tuple[Array, float, bool, dict[str, Any]]:
        """Advance by one control step of 0.02 s.

        Returns:
            Observation, reward (always 0: trainers bring their own), whether the episode is over, and `info` with
            `constraints_value`, `jerk`, `success`; in the tournament a pair of constraint values, `score` and `faults`.

        Raises:
            ActionError: The action has the wrong shape or type, or is not finite; nothing was simulated.
            SimulationError: The engine warned.
        """
        self.step_count += 1
        self._take(action)
        noise = self._no_noise
        if self.disturbances.torque > 0.0:
            shape = (SUBSTEPS, *self._no_noise.shape[1:])
            noise = self.plant_random.standard_normal(shape) * self.torque_deviation
        self.simulation.step(self._action, noise, self.step_count)
        verdict = self.task.judge(self._referee, self.simulation.flat)
        self.verdict, self.succeeded = verdict & ~verdicts.SUCCESS, verdict >= verdicts.SUCCESS
        return self._observe(), 0.0, self.verdict != verdicts.GOING_ON, self._info()

    def get_state(self) -> State:
        """The present moment; what it holds is its own, and is not changed by anything that the environment does later."""
        episode = self._episode
        if episode is None or not self._start_is_own:
            streams = None if self._draws_at_steps else self._save_streams()
            episode = self._episode = Episode(self._start_random.get_state(), streams, self._mismatch.save())
        return State(
            self._made_for,
            self.simulation.save(),
            self._played.tobytes(),
            (self.step_count, self.verdict, self.succeeded),
            episode,
            self._save_streams() if self._draws_at_steps else None,
        )

    def set_state(self, state: State) -> None:
        """Go to a moment that this environment has saved, or another one made with the same arguments, here or elsewhere.

        Raises:
            ConfigurationError: It was saved of another kind of environment.
        """
        if state.made_for is not self._made_for and state.made_for != self._made_for:
            raise ConfigurationError(
                f"the state is one of {_told(state.made_for)}, not of {_told(self._made_for)}; "
                "make both environments with the same arguments"
            )
        self.simulation.restore(state.simulation)
        self._played[:] = state.game
        self.step_count, self.verdict, self.succeeded = state.progress
        if state.episode is not self._episode:
            self._restore_episode(state.episode)
        if state.streams is not None:
            self._restore_streams(state.streams)

    state = property(get_state, set_state, doc="The present moment; see `get_state` and `set_state`.")

    def _save_streams(self) -> tuple[Any, ...]:
        return self._plant_stream.save(), [perception.save() for perception in self.perceptions]

    def _restore_streams(self, streams: tuple[Any, ...]) -> None:
        plant, seen = streams
        self._plant_stream.restore(plant)
        for perception, saved in zip(self.perceptions, seen, strict=True):
            perception.restore(saved)

    def _restore_episode(self, episode: Episode) -> None:
        if not self._start_is_own:  # never rewind a generator that others draw from
            self._start_random, self._start_is_own = np.random.RandomState(), True
        self._start_random.set_state(episode.start)
        self._mismatch.restore(episode.plant)
        if episode.streams is not None:
            self._restore_streams(episode.streams)
        self._episode = episode

    def __getstate__(self) -> dict[str, Any]:
        """All but views and what is shared by the whole process; the generator of starts becomes the copy's own."""
        kept = {
            name: value for name, value in self.__dict__.items() if name not in ("task", "game", "_played", "_slots")
        }
        return kept | {"_episode": None, "_start_is_own": True}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.task = task(self.edition.environment(self.name).kind)
        self._make_views()

    def __deepcopy__(self, memo: dict[int, Any]) -> "Environment":
        simulation = self.simulation
        constant = [self.edition, self.disturbances, self.formats, self._starts, self.constraint_slices]
        constant += [simulation.robot, simulation.arm, simulation.robot_model]
        if self.disturbances.mismatch == Mismatch():
            constant.append(simulation.model)
        memo.update({id(shared): shared for shared in constant})
        memo[id(simulation.robot_data)] = simulation.copy_robot_data()  # MuJoCo's own would copy the model, too
        twin = memo[id(self)] = object.__new__(type(self))
        twin.__setstate__(copy.deepcopy(self.__getstate__(), memo))
        return twin

    def new_game(self) -> None:
        """Score and faults to zero, and a new draw of the side that serves first."""
        self._episode = None
        for kept, new in zip(self.game, new_game(), strict=True):
            kept[:] = new
        if self._is_game:
            self.game.serve[0] = self._start_random.choice([HOME_SERVES, AWAY_SERVES])

    def move_into(self, memory: NDArray[Any], referee: NDArray[Any], flat: Array) -> None:
        """Work from now on in arrays of the caller's, who steps many environments in one call (`airhockey.envs.vector`).

        Args:
            memory, referee: Of the types of `simulation.memory` and `referee`. Each of shape (1,).
            flat: See `Simulation.move_into`.
        """
        self.simulation.move_into(memory, flat)
        referee[:], self._referee = self._referee, referee
        self._make_views()

    @property
    def referee(self) -> NDArray[Any]:
        """The record of the rules and of the game. Shape (1,)."""
        return self._referee

    def draw_starts_from(self, random: np.random.RandomState) -> None:
        """Draw all starts from this generator, which others may draw from, too."""
        self._start_random, self._start_is_own, self._episode = random, False, None

    def _seed_streams(self, seed: int | np.random.SeedSequence) -> None:
        """One random stream per owner: the start, the plant, each player's perception."""
        sequence = seed if isinstance(seed, np.random.SeedSequence) else np.random.SeedSequence(seed)
        children = [_child(sequence, index) for index in range(4)]
        if isinstance(seed, np.random.SeedSequence):
            self._start_random = np.random.RandomState(np.random.MT19937(children[0]))
        else:
            self._start_random = np.random.RandomState(seed)
        self._start_is_own = True
        self.plant_random = np.random.default_rng(children[1])
        self._plant_stream = Stream(self.plant_random)
        self._perception_randoms = [np.random.default_rng(child) for child in children[2 : 2 + self.n_players]]
        self.new_game()

    def _draw_puck(self) -> tuple[Array, Array]:
        position, velocity = self.task.draw_start(self._starts, self._start_random)
        if self._is_game:
            position[0] *= self.game.serve[0]
        return position, velocity

    def _restore(self, state: Array) -> None:
        n, width = self.simulation.robot.n_joints, self.simulation.readings.observation.shape[1]
        if state.shape != (self.n_agents * width,) or not np.isfinite(state).all():
            raise ActionError(
                f"the state to reset to has shape {state.shape} or values that are not finite; "
                f"{self.name} takes a base observation of {self.n_agents * width} finite numbers"
            )
        rows = state.reshape(self.n_agents, width)
        puck = rows[-1]  # both robots' rows hold the puck
        self.simulation.reset(puck[:3], puck[3:6], rows[:, 6 : 6 + n].copy(), rows[:, 6 + n : 6 + 2 * n].copy())

    def _make_views(self) -> None:
        """Views of what Python and compiled code share."""
        self.game: Game = view(self._referee, Game)
        self._played = bytes_from(self._referee, Game).data
        self._slots = [self._action[r, : form.rows].reshape(form.shape) for r, form in enumerate(self.formats)]

    def _make_slices(self) -> None:
        """Where each reading stands in the simulation's flat array."""
        readings = self.simulation.readings
        base, width = readings.base.size, readings.base.shape[1]
        self._base = slice(base)
        self.observation_slice = slice(base, base + self.n_players * width)
        count = readings.constraints.shape[1]
        self._constraints = [
            {name: slice(first + part.start, first + part.stop) for name, part in self.constraint_slices.items()}
            for first in (2 * base, 2 * base + count)[: self.n_players]
        ]
        self.constraints_slice = slice(2 * base, 2 * base + self.n_players * count)
        self._jerk = slice(2 * base + readings.constraints.size, self.simulation.flat.size)

    def _take(self, action: Any) -> None:
        """Check the action and put it where compiled code reads it, which also checks that it is finite."""
        if self.n_players == 1:
            self._take_one(0, action)
            return
        if not isinstance(action, (tuple, list, np.ndarray)) or len(action) != 2:
            raise ActionError(f"step {self.step_count}: the tournament takes a pair of actions, one per player")
        self._take_one(0, action[0])
        self._take_one(1, action[1])

    def _take_one(self, player: int, action: Any) -> None:
        form = self.formats[player]
        if type(action) is not np.ndarray or action.shape != form.shape or action.dtype != FLOAT:
            label = f", player {player + 1}" if self.n_players == 2 else ""
            action = form.check(action, self.step_count, label)
        self._slots[player][...] = action

    def _observe(self) -> Array:
        if not self._blurred:
            return self.simulation.flat[self.observation_slice].copy()
        true = self.simulation.readings.observation
        return np.concatenate([see.observe(row) for see, row in zip(self.perceptions, true, strict=False)])

    def _info(self) -> dict[str, Any]:
        flat = self.simulation.flat
        by_name = [{name: flat[part] for name, part in parts.items()} for parts in self._constraints]
        if self.n_players == 2:
            return {"constraints_value": by_name, "jerk": flat[self._jerk], "score": self.score, "faults": self.faults}
        return {"constraints_value": by_name[0], "jerk": flat[self._jerk], "success": int(self.succeeded)}


def _child(sequence: np.random.SeedSequence, index: int) -> np.random.SeedSequence:
    """A child that depends on nothing but its parent and index (`spawn` counts how often it was called)."""
    return np.random.SeedSequence(sequence.entropy, spawn_key=(*sequence.spawn_key, index))


def _told(made_for: tuple[Any, ...]) -> str:
    """In words, what an environment was made with."""
    name, orders, year, disturbances = made_for
    return f"{name} (orders {', '.join(map(str, orders))}; edition {year}; disturbances {disturbances.profile})"


def _referee_rules(rules: Edition) -> verdicts.Rules:
    return verdicts.Rules(
        half_length=TABLE.length / 2,
        half_width=TABLE.width / 2,
        goal_half_width=TABLE.goal_width / 2,
        max_speed=rules.over.max_speed,
        near_x=rules.success.near_x,
        far_x=rules.success.far_x,
        band_half_width=rules.success.band_half_width,
        slow=rules.success.slow,
        standstill=rules.over.standstill,
        middle_line=rules.over.middle_line,
        fault_time=rules.game.fault_time,
        faults_per_point=rules.game.faults_per_point,
        middle_zone=rules.game.middle_zone,
        stuck_speed=rules.game.stuck_speed,
    )
