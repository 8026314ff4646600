"""The safety layer over the switcher: a task is changed only through home (thesis 4.3.2, figure 4.6)."""

from enum import StrEnum


class Task(StrEnum):
    """The states."""

    HOME = "home"
    HIT = "hit"
    DEFEND = "defend"
    PREPARE = "prepare"


class StateMachine:
    """Allows a task to go on, to begin again, or to end at home; from home every task may begin.

    Attributes:
        state: The task being played.
    """

    def __init__(self, through_home: bool = True) -> None:
        """Without `through_home` it is left out: whatever the switcher suggests is played (table 5.4)."""
        self._through_home = through_home
        self.reset()

    def reset(self) -> None:
        """A game always starts at home."""
        self.state = Task.HOME

    def advance(self, suggested: Task, finished: bool) -> Task:
        """The next state.

        Args:
            suggested: What the switcher would play.
            finished: The present task sent its signal of completion.
        """
        if finished:
            self.state = following(self.state, suggested) if self._through_home else suggested
        return self.state


def following(state: Task, suggested: Task) -> Task:
    """The state after a finished one: the suggested task if it is the same or the robot is at home, else home."""
    return suggested if state in (Task.HOME, suggested) else Task.HOME
