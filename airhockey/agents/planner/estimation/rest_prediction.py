"""Where a rolling puck would come to rest, from when it passes three lines; neither its damping nor its speed need be known.

A puck with damping c that comes to rest at R has the speed c (R − x) at x, so between two lines it takes the time
ln((R − x₁)/(R − x₂))/c. The ratio of two such times is a function of R alone, and grows with it.
"""

from math import log

LINES = (-0.3, 0.1, 0.5)
"""In [m]: free of our mallet, and not yet in the opponent's reach."""
NEAREST, FARTHEST = 0.55, 2.0
"""Between which R is looked for, in [m]; others are no rolling puck's."""


class RestPrediction:
    """Fed with the puck's x at every control step, from the strike on."""

    def __init__(self, dt: float) -> None:
        """Length of a control step, in [s]."""
        self._dt = dt
        self.begin()

    def begin(self) -> None:
        """A puck was struck."""
        self._times: list[float] = []
        self._time, self._before = 0.0, 0.0
        self._first = True

    def see(self, x: float) -> float | None:
        """Take a place, in [m]. Gives R in [m] once, when the last line is passed; None before, after, or where there is none."""
        before, self._before = self._before, x
        self._time += self._dt
        passed = len(self._times)
        if self._first or passed == len(LINES) or not before < LINES[passed] <= x:
            self._first = False
            return None
        self._times.append(self._time - self._dt * (x - LINES[passed]) / (x - before))
        return rest(self._times) if len(self._times) == len(LINES) else None


def rest(times: list[float]) -> float | None:
    """R from the times at the three lines, in [s]; None where it is not within bounds."""
    ratio = (times[1] - times[0]) / (times[2] - times[1])
    near, far = NEAREST, FARTHEST
    if not _ratio(near) < ratio < _ratio(far):
        return None
    for _ in range(30):
        middle = 0.5 * (near + far)
        near, far = (middle, far) if _ratio(middle) < ratio else (near, middle)
    return 0.5 * (near + far)


def _ratio(place: float) -> float:
    first, second, third = (place - line for line in LINES)
    return log(first / second) / log(second / third)
