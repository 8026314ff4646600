"""One player in a game: its agent, its clock, its failures, and what it is penalised for."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.editions import Edition
from airhockey.errors import ActionError
from airhockey.evaluator.judging.games import PenaltyCount
from airhockey.evaluator.play.episode import agent_failures, describe
from airhockey.evaluator.play.watchdog import Watch
from airhockey.evaluator.runs.game_records import Event, Side

Array = NDArray[np.float64]
TIME_LIMIT = 0.02
"""Longest time for one `draw_action`, in [s], before the previous position is held."""
HUGE = 1e6
"""No command of a robot has entries like this; one that does is what the simulation failed over."""


class Competitor:
    """One player in a game.

    Args:
        side: Which robot it plays.
        agent: Has `episode_start`, `draw_action` and perhaps `preprocessors`; None if it could not be built.
        form: Its action format, from the environment.
        rules: The edition.
        slices: Constraint name -> its part of the constraint values.
        clock: Measures `draw_action`, in [s].
        watch: Knows who is at work, for calls that never return.
        failure: Why there is no agent.

    Attributes:
        failure: Why it forfeits; None while it does not.
        penalties: Its penalty points so far.
        held: Steps in which its previous position was held.
        longest, total, steps: The longest `draw_action` and the sum of all, in [s], and their number.
    """

    def __init__(
        self,
        side: Side,
        agent: Any,
        form: Any,
        rules: Edition,
        slices: dict[str, slice],
        clock: Callable[[], float],
        watch: Watch,
        failure: str | None,
    ) -> None:
        self.side, self.agent, self.form, self.failure = side, agent, form, failure
        self.penalties = PenaltyCount(rules)
        self.held, self.longest, self.total, self.steps = 0, 0.0, 0.0, 0
        self._preprocessors = tuple(getattr(agent, "preprocessors", ()))
        self._slices, self._clock, self._watch = slices, clock, watch
        self._position: Array | None = None
        self._action = np.zeros(form.shape)
        episode = rules.horizon.task
        self._times = np.zeros(episode)
        self._values = np.zeros((episode, max(part.stop for part in slices.values())))
        self._seen = 0

    def serve(self, joint_position: Array) -> None:
        """A serve begins with the robot at these joints, in [rad]. Shape (n,)."""
        self._position = joint_position
        try:
            with self._watch.over(self.side):
                self.agent.episode_start()
        except agent_failures() as failure:
            self.failure = f"episode_start: {describe(failure)}"

    def act(self, observation: Array, step: int) -> tuple[Array, bool]:
        """The action of this step, and whether it is the held command of an agent that took too long."""
        try:
            with self._watch.over(self.side):
                for preprocessor in self._preprocessors:
                    observation = preprocessor(observation)
                begin = self._clock()
                action = self.agent.draw_action(observation)
                seconds = self._clock() - begin
            self._action = self.form.check(action, step)
        except ActionError as failure:
            return self._fail(str(failure))
        except agent_failures() as failure:
            return self._fail(f"step {step}: {describe(failure)}")
        self._times[self._seen] = seconds
        late = seconds > TIME_LIMIT
        if late:
            self.held += 1
            self._action = self.held_command()
        else:
            self._position = self.position_of(self._action)
        return self._action, late

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

    @property
    def action(self) -> Array:
        """What it sent last; zeros before that."""
        return self._action

    @property
    def commands_the_absurd(self) -> bool:
        """Whether its latest action is nothing that a robot could be sent."""
        return bool(np.abs(self._action).max() > HUGE)

    def see(self, constraints: Array) -> None:
        """Keep the constraint values after a step. Shape (K,)."""
        self._values[self._seen] = constraints
        self._seen += 1

    def end_episode(self, step: int) -> list[Event]:
        """An episode of 500 steps, or the rest of a game, is over: count its penalty.

        Args:
            step: The game's step that ended it.

        Returns:
            An event for every kind of violation, at the step where it was first seen.
        """
        seen, self._seen = self._seen, 0
        if seen == 0:
            return []
        values, times = self._values[:seen], self._times[:seen]
        self.longest, self.total = max(self.longest, float(times.max())), self.total + float(times.sum())
        self.steps += seen
        violated = {name: values[:, part].max(axis=1) for name, part in self._slices.items()}
        points = self.penalties.add_episode(
            {name: bool((worst > 0.0).any()) for name, worst in violated.items()},
            float(times.max()),
            float(times.mean()),
        )
        events = []
        for name, charged in points.items():
            if name in violated:
                first, what = int((violated[name] > 0.0).argmax()), f"up to {violated[name].max():.3g} beyond"
            else:
                first, what = (
                    int(times.argmax()),
                    f"up to {times.max() * 1e3:.1f} ms, {times.mean() * 1e3:.1f} ms on average",
                )
            why = f"{name}: {charged:g} points for this episode, {what}"
            events.append(Event(step=step - seen + 1 + first, what="violation", who=self.side, why=why))
        return events

    def _fail(self, why: str) -> tuple[Array, bool]:
        self.failure = why
        return self.held_command(), False
