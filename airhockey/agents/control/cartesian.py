"""Paths of the rod tip over the table, as functions of time: cubic, quintic, Bézier, and one after the other.

Each starts from a given position and velocity, so that a new one can take over from a motion under way.
"""

from dataclasses import dataclass
from math import comb
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class CartesianTrajectory(Protocol):
    """A motion in the plane of the table.

    Attributes:
        duration: In [s].
    """

    @property
    def duration(self) -> float:
        """In [s]."""

    def at(self, time: float) -> tuple[Array, Array]:
        """Position [m] and velocity [m]/[s] at a time, which is clipped to the duration. Shapes (2,), (2,)."""


@dataclass(frozen=True)
class PolynomialTrajectory:
    """Σ_k coefficients[k] t^k.

    Attributes:
        coefficients: Shape (degree + 1, 2).
        duration: In [s].
    """

    coefficients: Array
    duration: float

    def at(self, time: float) -> tuple[Array, Array]:
        """See `CartesianTrajectory.at`."""
        t = min(max(time, 0.0), self.duration)
        powers = t ** np.arange(len(self.coefficients))
        slopes = np.arange(1, len(self.coefficients)) * powers[:-1]
        return powers @ self.coefficients, slopes @ self.coefficients[1:]


def cubic(
    start: Array, start_velocity: Array, end: Array, end_velocity: Array, duration: float
) -> PolynomialTrajectory:
    """The cubic through both positions with both velocities.

    Args:
        start, end: In [m]. Shape (2,).
        start_velocity, end_velocity: In [m]/[s]. Shape (2,).
        duration: T, in [s].
    """
    way = (end - start) / duration
    quadratic = (3.0 * way - 2.0 * start_velocity - end_velocity) / duration
    third = (start_velocity + end_velocity - 2.0 * way) / duration**2
    return PolynomialTrajectory(np.stack([start, start_velocity, quadratic, third]), duration)


def quintic(
    start: tuple[Array, Array, Array], end: tuple[Array, Array, Array], duration: float
) -> PolynomialTrajectory:
    """The quintic through both positions with both velocities and both accelerations.

    Args:
        start, end: Position [m], velocity [m]/[s] and acceleration [m]/[s²]. Shapes (2,) each.
        duration: T, in [s].
    """
    t = duration
    low = np.stack([start[0], start[1], start[2] / 2.0])
    rest = np.stack(
        [
            end[0] - np.array([1.0, t, t**2]) @ low,
            end[1] - np.array([1.0, 2.0 * t]) @ low[1:],
            end[2] - 2.0 * low[2],
        ]
    )
    matrix = np.array([[t**3, t**4, t**5], [3 * t**2, 4 * t**3, 5 * t**4], [6 * t, 12 * t**2, 20 * t**3]])
    return PolynomialTrajectory(np.concatenate([low, np.linalg.solve(matrix, rest)]), duration)


@dataclass(frozen=True)
class BezierTrajectory:
    """A Bézier curve, run through by a parameter s that goes from 0 to 1 as a cubic in time.

    Attributes:
        points: Control points; the curve starts at the first towards the second and ends at the last, coming from the
            one before. Shape (degree + 1, 2).
        duration: In [s].
        start_speed, end_speed: Of the rod tip at both ends, in [m]/[s].
    """

    points: Array
    duration: float
    start_speed: float
    end_speed: float

    def at(self, time: float) -> tuple[Array, Array]:
        """See `CartesianTrajectory.at`."""
        t = min(max(time, 0.0), self.duration)
        first, last = (self.points[1] - self.points[0]), (self.points[-1] - self.points[-2])
        degree = len(self.points) - 1
        slope_0 = self.start_speed / max(degree * float(np.linalg.norm(first)), 1e-9)
        slope_1 = self.end_speed / max(degree * float(np.linalg.norm(last)), 1e-9)
        law = cubic(np.zeros(1), np.array([slope_0]), np.ones(1), np.array([slope_1]), self.duration)
        s, rate = law.at(t)
        position, derivative = bezier(self.points, float(s[0]))
        return position, derivative * float(rate[0])


def bezier(points: Array, s: float) -> tuple[Array, Array]:
    """Point and derivative by s of a Bézier curve.

    Args:
        points: Control points. Shape (degree + 1, 2).
        s: Parameter, from 0 to 1.

    Returns:
        Shapes (2,), (2,).
    """
    degree = len(points) - 1
    return _bernstein(degree, s) @ points, degree * (_bernstein(degree - 1, s) @ np.diff(points, axis=0))


def _bernstein(degree: int, s: float) -> Array:
    return np.array([comb(degree, k) * s**k * (1.0 - s) ** (degree - k) for k in range(degree + 1)])


@dataclass(frozen=True)
class CompositeTrajectory:
    """Trajectories one after the other.

    Attributes:
        pieces: At least one.
    """

    pieces: tuple[CartesianTrajectory, ...]

    @property
    def duration(self) -> float:
        """Of all pieces together, in [s]."""
        return sum(piece.duration for piece in self.pieces)

    def at(self, time: float) -> tuple[Array, Array]:
        """See `CartesianTrajectory.at`."""
        for piece in self.pieces[:-1]:
            if time < piece.duration:
                return piece.at(time)
            time -= piece.duration
        return self.pieces[-1].at(time)
