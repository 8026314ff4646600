"""What a player of a game is penalised for: constraint values and times of an episode of 500 steps, and their points."""

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.editions import Edition
from airhockey.evaluator.judging.games import PenaltyCount
from airhockey.evaluator.play.seat import Seat
from airhockey.evaluator.runs.game_records import Event
from airhockey.evaluator.runs.records import StepTime

Array = NDArray[np.float64]


class Penalties:
    """The penalties of one player.

    Args:
        seat: The player's.
        rules: The edition.
        slices: Constraint name -> its part of the constraint values.

    Attributes:
        count: The points so far.
        held: Steps in which its previous position was held.
    """

    def __init__(self, seat: Seat, rules: Edition, slices: dict[str, slice]) -> None:
        self._seat, self._slices = seat, slices
        self.count, self.held = PenaltyCount(rules), 0
        episode = rules.horizon.task
        self._times = np.zeros(episode)
        self._values = np.zeros((episode, max(part.stop for part in slices.values())))
        self._seen, self._steps, self._total, self._longest = 0, 0, 0.0, 0.0

    @property
    def computation_time(self) -> StepTime:
        """Of the episodes that are over."""
        return StepTime(mean=self._total / max(self._steps, 1), max=self._longest)

    def see(self, constraints: Array) -> None:
        """Keep what came of a step. Shape (K,)."""
        self._times[self._seen] = self._seat.seconds
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
        longest, mean = float(times.max()), float(times.mean())
        self._longest, self._total = max(self._longest, longest), self._total + float(times.sum())
        self._steps += seen
        violated = {name: values[:, part].max(axis=1) for name, part in self._slices.items()}
        points = self.count.add_episode(
            {name: bool((worst > 0.0).any()) for name, worst in violated.items()}, longest, mean
        )
        events = []
        for name, charged in points.items():
            if name in violated:
                first, what = int((violated[name] > 0.0).argmax()), f"up to {violated[name].max():.3g} beyond"
            else:
                first, what = int(times.argmax()), f"up to {longest * 1e3:.1f} ms, {mean * 1e3:.1f} ms on average"
            why = f"{name}: {charged:g} points for this episode, {what}"
            at, who = step - seen + 1 + first, self._seat.side
            events.append(Event(step=at, what="violation", who=who, why=why, points=charged))
        return events
