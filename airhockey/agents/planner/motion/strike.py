"""A strike: the mallet starts at rest, meets the puck at full speed on a straight line, and brakes on it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def run_up(speed: float, acceleration: float, steady: float) -> tuple[float, float]:
    """Length [m] and time [s] of the way to the contact: acceleration, then `steady` seconds at full speed."""
    return 0.5 * speed * speed / acceleration + speed * steady, speed / acceleration + steady


@dataclass(frozen=True)
class Strike:
    """A motion along the line through the contact point, as a function of the time since it began.

    Attributes:
        contact: Centre of the mallet when it touches the puck, in [m]. Shape (2,).
        normal: Direction of the strike, unit vector. Shape (2,).
        speed: At contact, in [m]/[s].
        acceleration, braking: Before and after, in [m]/[s²].
        steady: Time at full speed before the contact, in [s].
        follow: Time at full speed after the contact, in [s].
        offset, drift: How far from the line's start the mallet really is when the strike begins, in [m], and how fast it still
            moves there, in [m]/[s]; both are gone at contact. Shapes (2,), (2,).
    """

    contact: Array
    normal: Array
    speed: float
    acceleration: float
    braking: float
    steady: float
    follow: float
    offset: Array
    drift: Array

    @property
    def contact_time(self) -> float:
        """From the beginning, in [s]."""
        return run_up(self.speed, self.acceleration, self.steady)[1]

    @property
    def start(self) -> Array:
        """Where the line begins, in [m]. Shape (2,)."""
        return self.contact - run_up(self.speed, self.acceleration, self.steady)[0] * self.normal

    @property
    def duration(self) -> float:
        """Until the mallet has stopped, in [s]."""
        return self.contact_time + self.follow + self.speed / self.braking

    def at(self, time: float) -> tuple[Array, Array]:
        """Position [m] and velocity [m]/[s] of the mallet. Shapes (2,), (2,)."""
        distance, rate = self._along(time)
        share = min(max(time / self.contact_time, 0.0), 1.0)
        left, slope = (1.0 + 2.0 * share) * (1.0 - share) ** 2, -6.0 * share * (1.0 - share) / self.contact_time
        # Cubic Hermite: the offset and the drift at the beginning fade out until contact.
        moved, moving = time * (1.0 - share) ** 2, (1.0 - share) * (1.0 - 3.0 * share)
        return (
            self.start + distance * self.normal + left * self.offset + moved * self.drift,
            rate * self.normal + slope * self.offset + moving * self.drift,
        )

    def _along(self, time: float) -> tuple[float, float]:
        """Distance from the line's start, and speed."""
        v, gained = self.speed, self.speed / self.acceleration
        if time < gained:
            return 0.5 * self.acceleration * time**2, self.acceleration * time
        length = 0.5 * v * gained
        steady = self.steady + self.follow
        if time < gained + steady:
            return length + v * (time - gained), v
        braking = min(time - gained - steady, v / self.braking)
        return length + v * steady + v * braking - 0.5 * self.braking * braking**2, v - self.braking * braking
