"""What has become of the shots at the goal in this game: whether it is worth to go on shooting at it."""

PATIENCE = 3
"""Shots that may fail before they count as futile; and as many more for every goal."""
FLIGHT = 3.0
"""Time after which a shot has failed, in [s]: then the puck has stopped, or come back."""


class ShotStatistics:
    """Told of every strike and of every serve: a serve soon after a strike means that it was a goal.

    Attributes:
        scored, failed: Numbers of shots so far.
    """

    def __init__(self) -> None:
        self.scored, self.failed = 0, 0
        self._since: float | None = None

    @property
    def futile(self) -> bool:
        """Whether the opponent's defence stops (nearly) everything."""
        return self.failed >= PATIENCE * (1 + self.scored)

    def struck(self) -> None:
        """The puck was sent at the goal just now."""
        self._since = 0.0

    def wait(self, dt: float) -> None:
        """Time passes, in [s]."""
        if self._since is not None:
            self._since += dt
            if self._since > FLIGHT:
                self.failed += 1
                self._since = None

    def serve(self) -> None:
        """The referee has interrupted the game."""
        if self._since is not None:
            self.scored += 1
            self._since = None
