"""For how long the puck has been on our side: after 15 s there it is a fault (challenge's section 6)."""

HURRY = 8.0
"""Time after which any stroke that sends the puck away will do, in [s]."""


class SideClock:
    """Counts from when the puck comes over the middle.

    Attributes:
        held: Time that the puck has been on our side, in [s].
    """

    def __init__(self, dt: float) -> None:
        """Length of a control step, in [s]."""
        self._dt = dt
        self.reset()

    def reset(self) -> None:
        """A serve."""
        self.held = 0.0

    def see(self, x: float) -> float:
        """Take the puck's x in the table frame, in [m], at every control step; gives `held`."""
        self.held = self.held + self._dt if x < 0.0 else 0.0
        return self.held
