"""Playing one game: both agents propose, the environment moves and referees, everything is kept for the judge."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.editions import edition
from airhockey.envs.kernel import referee
from airhockey.errors import ActionError
from airhockey.evaluator.episode import CLOCKS, agent_failures, describe
from airhockey.evaluator.games.film import Film
from airhockey.evaluator.games.judging import PenaltyCount, game_class, winner
from airhockey.evaluator.games.records import (
    AWAY,
    HOME,
    SIDES,
    Event,
    GameJob,
    GameOptions,
    GameRecord,
    PlayerResult,
    Side,
)
from airhockey.evaluator.records import StepTime
from airhockey.evaluator.seeding import seed_global_generators

Array = NDArray[np.float64]
TIME_LIMIT = 0.02
"""Longest time for one `draw_action`, in [s], before the previous position is held."""
_SERVER_OF = {referee.GOAL_HOME: AWAY, referee.GOAL_AWAY: HOME, referee.FAULT_HOME: AWAY, referee.FAULT_AWAY: HOME}


@dataclass
class Status:
    """How a game stands, for a live line."""

    step: int = 0
    score: tuple[int, int] = (0, 0)
    faults: tuple[int, int] = (0, 0)
    penalty: tuple[float, float] = (0.0, 0.0)
    side: Side = HOME


class Competitor:
    """One player in a game: its agent, its clock, what it did.

    Args:
        agent: Has `episode_start` and `draw_action`; None if it could not be built.
        form: Its action format, from the environment.
        penalties: Counts its penalty points.
        clock: Measures `draw_action`, in [s].
        failure: Why there is no agent.
    """

    def __init__(
        self, agent: Any, form: Any, penalties: PenaltyCount, clock: Callable[[], float], failure: str | None
    ) -> None:
        self.agent, self.form, self.penalties = agent, form, penalties
        self.failure = failure
        self.held, self.longest, self.total, self.steps = 0, 0.0, 0.0, 0
        self._clock = clock
        self._position: Array | None = None
        self._times: list[float] = []
        self._worst: Array | None = None

    def serve(self, joint_position: Array) -> None:
        """A serve begins with the robot at these joints, in [rad]. Shape (n,)."""
        self._position = joint_position
        try:
            self.agent.episode_start()
        except agent_failures() as failure:
            self.failure = f"episode_start: {describe(failure)}"

    def act(self, observation: Array, step: int) -> tuple[Array, bool]:
        """The action of this step, and whether it is the held command of an agent that took too long."""
        begin = self._clock()
        try:
            action = self.agent.draw_action(observation)
            seconds = self._clock() - begin
            action = self.form.check(action, step)
        except ActionError as failure:
            return self._fail(str(failure))
        except agent_failures() as failure:
            return self._fail(f"step {step}: {describe(failure)}")
        self._times.append(seconds)
        late = seconds > TIME_LIMIT
        if late:
            self.held += 1
            action = self.held_command()
        else:
            self._position = self.position_of(action)
        return action, late

    def held_command(self) -> Array:
        """The previous position command with zero velocity, in the shape of an action."""
        action = np.zeros(self.form.shape)
        if self.form.order is None:
            action[:, 0] = self._position
        elif action.ndim == 1:
            action[:] = self._position
        else:
            action[0] = self._position
        return action

    def position_of(self, action: Array) -> Array:
        """The position that an action commands for its end. Shape (n,)."""
        if self.form.order is None:
            return np.asarray(action[-1, 0])
        return np.asarray(action if action.ndim == 1 else action[0])

    def see(self, constraints: Array) -> None:
        """Keep the worst value of each constraint in this episode. Shape (K,)."""
        if self._worst is None:
            self._worst = constraints.copy()
        else:
            np.maximum(self._worst, constraints, out=self._worst)

    def end_episode(self, slices: dict[str, slice]) -> None:
        """500 steps are over: count their penalty."""
        if self._worst is None:
            return
        violated = {name: bool((self._worst[part] > 0.0).any()) for name, part in slices.items()}
        times = np.array(self._times or [0.0])
        self.penalties.add_episode(violated, float(times.max()), float(times.mean()))
        self.longest, self.total = max(self.longest, float(times.max())), self.total + float(times.sum())
        self.steps += len(self._times)
        self._worst = None
        self._times.clear()

    def _fail(self, why: str) -> tuple[Array, bool]:
        self.failure = why
        return self.held_command(), False


@dataclass
class GamePlay:
    """A game in progress.

    Args:
        job: Which game.
        options: How it is played.
        env: The tournament environment.
        agents: Home's and away's, None where one could not be built.
        failures: Why not.
        film: Keeps what is needed to show the game again; None for nothing.
        on_step: Called with the status after every `every` steps.
    """

    job: GameJob
    options: GameOptions
    env: Any
    agents: tuple[Any, Any]
    failures: tuple[str | None, str | None] = (None, None)
    film: Film | None = None
    on_step: Callable[[Status], None] | None = None
    every: int = 250
    events: list[Event] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.rules = edition(self.options.edition)
        clock = CLOCKS[self.options.clock]
        self.competitors = [
            Competitor(agent, form, PenaltyCount(self.rules), clock, failure)
            for agent, form, failure in zip(self.agents, self.env.formats, self.failures, strict=True)
        ]
        self.goals = [0, 0]
        self.status = Status()

    def play(self) -> GameRecord:
        """Play to the last step, or to a forfeit."""
        environment, agents = np.random.SeedSequence(self.job.seed).spawn(2)
        seed_global_generators(agents)
        observation = self._serve(self.env.reset(seed=environment), 0)
        step = 0
        while step < self.options.steps and not self._forfeit(step):
            step += 1
            observation = self._step(observation, step)
        for competitor in self.competitors:
            competitor.end_episode(self.env.constraint_slices)
        return self._record(step)

    def _step(self, observation: Array, step: int) -> Array:
        half = observation.size // 2
        actions = []
        for side, competitor, seen in zip(
            SIDES, self.competitors, (observation[:half], observation[half:]), strict=True
        ):
            action, held = competitor.act(seen.copy(), step)
            actions.append(action)
            if held:
                self.events.append(Event(step=step, what="held", who=side))
        if self._forfeit(step):
            return observation
        observation, _, over, _ = self.env.step((actions[0], actions[1]))
        for competitor, constraints in zip(self.competitors, self.env.constraint_values, strict=True):
            competitor.see(constraints)
        if self.film is not None:
            self.film.add(self.env)
        if step % self.rules.horizon.task == 0:
            for competitor in self.competitors:
                competitor.end_episode(self.env.constraint_slices)
        if over:
            self._note(self.env.verdict, step)
            observation = self._serve(self.env.reset(), step)
        if self.on_step is not None and step % self.every == 0:
            self._report(step)
        return observation

    def _serve(self, observation: Array, step: int) -> Array:
        """Both agents hear of the serve."""
        half = observation.size // 2
        joints = self.env.env_info["joint_pos_ids"]
        for k, competitor in enumerate(self.competitors):
            if competitor.failure is None:
                competitor.serve(self.env.true_observation[k * half : (k + 1) * half][joints])
        who = HOME if self.env.base_observation[0] < 0.0 else AWAY
        self.events.append(Event(step=step, what="serve", who=who, score=self._score()))
        return observation

    def _note(self, verdict: int, step: int) -> None:
        """Turn the referee's verdict into events."""
        if verdict in (referee.GOAL_HOME, referee.GOAL_AWAY):
            scorer = 0 if verdict == referee.GOAL_HOME else 1
            self.goals[scorer] += 1
            self.events.append(Event(step=step, what="goal", who=SIDES[scorer], score=self._score()))
        elif verdict in (referee.FAULT_HOME, referee.FAULT_AWAY):
            guilty = 0 if verdict == referee.FAULT_HOME else 1
            self.events.append(Event(step=step, what="fault", who=SIDES[guilty], score=self._score()))
            if self.env.faults[guilty] % self.rules.game.faults_per_point == 0:
                self.events.append(Event(step=step, what="point", who=SIDES[1 - guilty], score=self._score()))
        else:
            self.events.append(Event(step=step, what="stuck" if verdict == referee.STUCK else "out"))

    def _forfeit(self, step: int) -> bool:
        """Whether a player has failed; said once for each."""
        failed = False
        for side, competitor in zip(SIDES, self.competitors, strict=True):
            if competitor.failure is not None:
                failed = True
                event = Event(step=step, what="forfeit", who=side, why=competitor.failure)
                if event not in self.events:
                    self.events.append(event)
        return failed

    def _score(self) -> tuple[int, int]:
        home, away = self.env.score
        return home, away

    def _report(self, step: int) -> None:
        faults = self.env.faults
        side = HOME if self.env.base_observation[0] < 0.0 else AWAY
        penalty = self.competitors[0].penalties.points, self.competitors[1].penalties.points
        self.status = Status(step, self._score(), (faults[0], faults[1]), penalty, side)
        if self.on_step is not None:
            self.on_step(self.status)

    def _record(self, steps: int) -> GameRecord:
        length = max(steps, 1)
        home, away = (self._result(k, length) for k in range(2))
        return GameRecord(
            job=self.job,
            steps=steps,
            home=home,
            away=away,
            winner=winner(self.rules, self.options.variant, self.options.steps, home, away),
            events=tuple(self.events),
        )

    def _result(self, k: int, steps: int) -> PlayerResult:
        competitor, penalties = self.competitors[k], self.competitors[k].penalties
        return PlayerResult(
            goals=self.goals[k],
            points_by_faults=self._score()[k] - self.goals[k],
            faults=self.env.faults[k],
            penalty=penalties.points,
            deployability=game_class(self.rules, penalties.points, steps),
            violations=dict(penalties.violations),
            held=competitor.held,
            computation_time=StepTime(mean=competitor.total / max(competitor.steps, 1), max=competitor.longest),
            failure=competitor.failure,
        )
