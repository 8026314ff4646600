"""What happens in a game, told as events: serves, goals, faults, commands that were held, forfeits."""

from collections.abc import Sequence
from typing import Any

from airhockey.envs.tasks import verdicts
from airhockey.evaluator.play.seat import Seat
from airhockey.evaluator.runs.game_records import AWAY, HOME, SIDES, Event, Side


class EventLog:
    """The events of a game so far.

    Args:
        env: The tournament environment.
        faults_per_point: So many faults give the opponent a point.

    Attributes:
        events: In the order in which they were noticed.
        goals: Points by goals, of home and away.
    """

    def __init__(self, env: Any, faults_per_point: int) -> None:
        self._env, self._per_point = env, faults_per_point
        self.events: list[Event] = []
        self.goals = [0, 0]

    @property
    def score(self) -> tuple[int, int]:
        """All points of home and away."""
        home, away = self._env.score
        return home, away

    @property
    def side(self) -> Side:
        """Where the puck is."""
        return HOME if self._env.base_observation[0] < 0.0 else AWAY

    def serve(self, step: int) -> None:
        """The puck has been served."""
        self.events.append(Event(step=step, what="serve", who=self.side, score=self.score))

    def held(self, step: int, side: Side) -> None:
        """A player took too long, and its previous position is held."""
        self.events.append(Event(step=step, what="held", who=side))

    def verdict(self, step: int) -> None:
        """The referee has ended the serve."""
        verdict = self._env.verdict
        x, y, _, speed_x, speed_y, _ = self._env.base_observation[:6]
        where = f"the puck was at ({x:+.3f}, {y:+.3f}) m with ({speed_x:+.2f}, {speed_y:+.2f}) m/s"
        if verdict in (verdicts.GOAL_HOME, verdicts.GOAL_AWAY):
            scorer = 0 if verdict == verdicts.GOAL_HOME else 1
            self.goals[scorer] += 1
            self.events.append(Event(step=step, what="goal", who=SIDES[scorer], score=self.score, why=where))
        elif verdict in (verdicts.FAULT_HOME, verdicts.FAULT_AWAY):
            self._fault(0 if verdict == verdicts.FAULT_HOME else 1, step, where)
        else:
            what = "stuck" if verdict == verdicts.STUCK else "out"
            self.events.append(Event(step=step, what=what, score=self.score, why=where))

    def forfeits(self, step: int, seats: Sequence[Seat]) -> None:
        """Those who have failed forfeit the game."""
        for seat in seats:
            if seat.failure is not None:
                why = seat.failure
                self.events.append(Event(step=step, what="forfeit", who=seat.side, score=self.score, why=why))

    def _fault(self, guilty: int, step: int, where: str) -> None:
        since = float(self._env.game.timer[0])
        why = f"its side held the puck for {since:.2f} s; {where}"
        self.events.append(Event(step=step, what="fault", who=SIDES[guilty], score=self.score, why=why))
        faults = self._env.faults[guilty]
        if faults % self._per_point == 0:
            why = f"fault {faults} of {SIDES[guilty]}, and every {self._per_point} give a point"
            self.events.append(Event(step=step, what="point", who=SIDES[1 - guilty], score=self.score, why=why))
