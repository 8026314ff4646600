"""Playing one game: both agents propose, the environment moves and referees, everything is kept for the judge."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.editions import edition
from airhockey.envs.tasks import verdicts
from airhockey.errors import ActionError, SimulationError
from airhockey.evaluator.isolation.handle import AgentHandle
from airhockey.evaluator.judging.games import game_class, winner
from airhockey.evaluator.play.competitor import Competitor
from airhockey.evaluator.play.episode import CLOCKS
from airhockey.evaluator.play.seeding import seed_global_generators
from airhockey.evaluator.play.watchdog import Watch
from airhockey.evaluator.runs.game_records import (
    AWAY,
    HOME,
    SIDES,
    Event,
    GameJob,
    GameOptions,
    GameRecord,
    PlayerResult,
    Side,
    Status,
)
from airhockey.evaluator.runs.game_trajectories import Film
from airhockey.evaluator.runs.records import StepTime

Array = NDArray[np.float64]
OnStep = Callable[[Status], None]


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
        watch: Watches the agents.
        on_step: Called with the status after every `every` steps.
    """

    job: GameJob
    options: GameOptions
    env: Any
    agents: tuple[Any, Any]
    failures: tuple[str | None, str | None] = (None, None)
    film: Film | None = None
    watch: Watch = field(default_factory=Watch)
    on_step: OnStep | None = None
    every: int = 250
    events: list[Event] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.rules = edition(self.options.edition)
        slices = self.env.constraint_slices
        self.competitors = [
            Competitor(side, agent, form, self.rules, slices, self._clock_of(agent), self.watch, failure)
            for side, agent, form, failure in zip(SIDES, self.agents, self.env.formats, self.failures, strict=True)
        ]
        self.goals = [0, 0]
        self._reported = 0, time.monotonic()

    def play(self) -> GameRecord:
        """Play to the last step, or to a forfeit."""
        observation, step = self.begin(), 0
        while step < self.options.steps and not self._forfeit(step):
            step += 1
            observation = self.step(observation, step)
        return self.end(step)

    def begin(self) -> Array:
        """Seed everything and serve; gives the first observation. Shape (46,)."""
        environment, agents = np.random.SeedSequence(self.job.seed).spawn(2)
        seed_global_generators(agents)
        for agent, seed in zip(self.agents, agents.spawn(2), strict=True):
            if isinstance(agent, AgentHandle):
                agent.seed(seed)
        return self._serve(self.env.reset(seed=environment), 0)

    def step(self, observation: Array, step: int) -> Array:
        """One control step, and a new serve where it ends one; gives the next observation. Shapes (46,)."""
        half = observation.size // 2
        actions = []
        for competitor, seen in zip(self.competitors, (observation[:half], observation[half:]), strict=True):
            action, held = competitor.act(seen.copy(), step)
            actions.append(action)
            if held:
                self.events.append(Event(step=step, what="held", who=competitor.side))
        if self._forfeit(step):
            return observation
        try:
            observation, _, over, _ = self.env.step((actions[0], actions[1]))
        except (ActionError, SimulationError) as error:
            self._blame(f"step {step}: {str(error).partition(': ')[2]}")  # it counts from the serve
            return observation
        for competitor, constraints in zip(self.competitors, self.env.constraint_values, strict=True):
            competitor.see(constraints)
        if self.film is not None:
            self.film.add(self.env)
        if step % self.rules.horizon.task == 0:
            self._end_episode(step)
        if over:
            self._note(self.env.verdict, step)
            observation = self._serve(self.env.reset(), step)
        if step % self.every == 0:
            self._report(step)
        return observation

    def end(self, step: int) -> GameRecord:
        """The record of a game that ended with this step."""
        self._forfeit(step)
        self._end_episode(step)
        home, away = (self._result(k, max(step, 1)) for k in range(2))
        return GameRecord(
            job=self.job,
            steps=step,
            home=home,
            away=away,
            winner=winner(self.rules, self.options.variant, self.options.steps, home, away),
            events=tuple(sorted(self.events, key=lambda event: event.step)),
        )

    def _clock_of(self, agent: Any) -> Callable[[], float]:
        return agent.clock(self.options.clock) if isinstance(agent, AgentHandle) else CLOCKS[self.options.clock]

    def _end_episode(self, step: int) -> None:
        for competitor in self.competitors:
            self.events += competitor.end_episode(step)

    def _serve(self, observation: Array, step: int) -> Array:
        """Both agents hear of the serve."""
        half = observation.size // 2
        joints = self.env.env_info["joint_pos_ids"]
        for k, competitor in enumerate(self.competitors):
            if competitor.failure is None:
                competitor.serve(self.env.true_observation[k * half : (k + 1) * half][joints])
        self.events.append(Event(step=step, what="serve", who=self._side(), score=self._score()))
        return observation

    def _note(self, verdict: int, step: int) -> None:
        """Turn the referee's verdict into events."""
        x, y, _, speed_x, speed_y, _ = self.env.base_observation[:6]
        where = f"the puck was at ({x:+.3f}, {y:+.3f}) m with ({speed_x:+.2f}, {speed_y:+.2f}) m/s"
        if verdict in (verdicts.GOAL_HOME, verdicts.GOAL_AWAY):
            scorer = 0 if verdict == verdicts.GOAL_HOME else 1
            self.goals[scorer] += 1
            self.events.append(Event(step=step, what="goal", who=SIDES[scorer], score=self._score(), why=where))
        elif verdict in (verdicts.FAULT_HOME, verdicts.FAULT_AWAY):
            self._note_fault(0 if verdict == verdicts.FAULT_HOME else 1, step, where)
        else:
            what = "stuck" if verdict == verdicts.STUCK else "out"
            self.events.append(Event(step=step, what=what, score=self._score(), why=where))

    def _note_fault(self, guilty: int, step: int, where: str) -> None:
        since = float(self.env.game.timer[0])
        why = f"its side held the puck for {since:.2f} s; {where}"
        self.events.append(Event(step=step, what="fault", who=SIDES[guilty], score=self._score(), why=why))
        faults, per_point = self.env.faults[guilty], self.rules.game.faults_per_point
        if faults % per_point == 0:
            why = f"fault {faults} of {SIDES[guilty]}, and every {per_point} give a point"
            self.events.append(Event(step=step, what="point", who=SIDES[1 - guilty], score=self._score(), why=why))

    def _blame(self, why: str) -> None:
        """The simulation failed: over the player whose command was absurd, or over both."""
        absurd = [competitor for competitor in self.competitors if competitor.commands_the_absurd]
        for competitor in absurd or self.competitors:
            competitor.failure = why

    def _forfeit(self, step: int) -> bool:
        """Whether a player has failed; said once for each."""
        failed = [competitor for competitor in self.competitors if competitor.failure is not None]
        if not failed:
            return False
        told = {event.who for event in self.events if event.what == "forfeit"}
        for competitor in failed:
            if competitor.side not in told:
                event = Event(
                    step=step, what="forfeit", who=competitor.side, score=self._score(), why=competitor.failure
                )
                self.events.append(event)
        return True

    def _score(self) -> tuple[int, int]:
        home, away = self.env.score
        return home, away

    def _side(self) -> Side:
        return HOME if self.env.base_observation[0] < 0.0 else AWAY

    def _report(self, step: int) -> None:
        before, since = self._reported
        self._reported = step, time.monotonic()
        status = Status(
            key=self.job.key,
            home=self.job.home,
            away=self.job.away,
            step=step,
            steps=self.options.steps,
            score=self._score(),
            faults=(self.env.faults[0], self.env.faults[1]),
            penalty=(self.competitors[0].penalties.points, self.competitors[1].penalties.points),
            side=self._side(),
            rate=(step - before) / max(self._reported[1] - since, 1e-9),
        )
        self.watch.tell(status)
        if self.on_step is not None:
            self.on_step(status)

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
