"""What has become of a shot: watched from the strike to the next serve, or until the opponent has had the puck long enough."""

FLIGHT = 5.0
"""Time after which a shot has failed, in [s]: then the puck has stopped, or come back."""
THEIRS = 0.1
"""x of the puck beyond which a serve on our side was the opponent's fault, in [m]; else it was a goal in ours."""
FAULT = 1.0 / 3.0
"""Points that a fault of the opponent's is worth."""


class Outcome:
    """Told of every strike, every step and every serve; says once what the last strike has brought."""

    def __init__(self) -> None:
        self._arm: str | None = None
        self._last: str | None = None
        self._since, self._x = 0.0, 0.0
        self._served = False
        self._failed: list[str] = []

    def struck(self, arm: str) -> None:
        """The puck was played just now: the stroke before has brought nothing."""
        if self._arm is not None:
            self._failed.append(self._arm)
        self._arm = self._last = arm
        self._since = 0.0

    def serve(self) -> None:
        """The referee has interrupted the game; the next `see` shows on which side it goes on."""
        self._served = True

    def see(self, x: float, dt: float) -> list[tuple[str, float]]:
        """Take the puck's x, in [m], after dt [s]. Gives arms and their points, where something is decided.

        After a serve the puck lies on the side that has conceded, or that has not committed the fault.
        """
        before, self._x = self._x, x
        told, self._failed = [(arm, 0.0) for arm in self._failed], []
        self._since += dt
        if self._served:
            self._served = False
            if self._arm is not None:
                told.append((self._arm, 1.0 if x > 0.0 else 0.0))
            elif self._last is not None and before > THEIRS and x < 0.0:
                told.append((self._last, FAULT))
            self._arm = self._last = None
        elif self._arm is not None and self._since > FLIGHT:
            told.append((self._arm, 0.0))
            self._arm = None
        return told
