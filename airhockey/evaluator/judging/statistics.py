"""Are two shares of successes different? Exact tests and score intervals, by their definitions.

Two runs whose episodes have the same seeds met the same starts: they are compared episode by episode (McNemar). Others are
compared as two samples (Fisher). The intervals of a difference are Newcombe's, which are built from Wilson's and stay within
-1 … 1: R. G. Newcombe, Statistics in Medicine 17 (1998), 873–890 (two samples, method 10) and 2635–2650 (pairs, method 10).
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from airhockey.evaluator.judging.tasks import wilson_interval

_SAME = 1.0 + 1e-7  # probabilities that are equal but for rounding count as equal, as is usual


class Difference(NamedTuple):
    """The difference of two shares: its estimate, its 95 % interval, and the chance of one as large if there were none."""

    estimate: float
    low: float
    high: float
    p_value: float


def compare_pairs(both: int, only_first: int, only_second: int, neither: int) -> Difference:
    """The difference (first minus second) of two shares over the same episodes.

    Args:
        both, only_first, only_second, neither: Numbers of episodes that both, one or none of them won; at least one in all.
    """
    count = both + only_first + only_second + neither
    first, second = both + only_first, both + only_second
    low, high = _paired_interval(both, only_first, only_second, neither)
    return Difference((first - second) / count, low, high, mcnemar(only_first, only_second))


def compare_samples(first: int, first_trials: int, second: int, second_trials: int) -> Difference:
    """The difference (first minus second) of the shares of two independent samples, each of at least one trial."""
    p, q = first / first_trials, second / second_trials
    (p_low, p_high), (q_low, q_high) = wilson_interval(first, first_trials), wilson_interval(second, second_trials)
    low = p - q - math.hypot(p - p_low, q_high - q)
    high = p - q + math.hypot(p_high - p, q - q_low)
    return Difference(p - q, low, high, fisher(first, first_trials - first, second, second_trials - second))


def mcnemar(only_first: int, only_second: int) -> float:
    """Two-sided p-value of the exact McNemar test: a fair coin decides each episode that only one of the two won."""
    discordant, fewer = only_first + only_second, min(only_first, only_second)
    if discordant == 0:
        return 1.0
    tail = np.exp(_log_choose(discordant, np.arange(fewer + 1)) - discordant * math.log(2.0)).sum()
    return min(1.0, 2.0 * float(tail))


def fisher(a: int, b: int, c: int, d: int) -> float:
    """Two-sided p-value of Fisher's exact test of the table ((a, b), (c, d)).

    It is the probability, with the margins given, of every table that is at most as likely as this one.
    """
    row, column, total = a + b, a + c, a + b + c + d
    lowest, highest = max(0, row + column - total), min(row, column)
    k = np.arange(lowest, highest + 1)
    logs = _log_choose(column, k) + _log_choose(total - column, row - k) - _log_choose(total, np.array([row]))
    probabilities = np.exp(logs)
    return min(1.0, float(probabilities[probabilities <= probabilities[a - lowest] * _SAME].sum()))


def holm(p_values: Sequence[float]) -> list[float]:
    """P-values adjusted for there being several tests (Holm 1979): the chance of even one false alarm stays what it was."""
    order = sorted(range(len(p_values)), key=p_values.__getitem__)
    adjusted, largest = [1.0] * len(p_values), 0.0
    for rank, index in enumerate(order):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[index]))
        adjusted[index] = largest
    return adjusted


def _paired_interval(both: int, only_first: int, only_second: int, neither: int) -> tuple[float, float]:
    count = both + only_first + only_second + neither
    first, second = both + only_first, both + only_second
    p, q = first / count, second / count
    (p_low, p_high), (q_low, q_high) = wilson_interval(first, count), wilson_interval(second, count)
    phi = _correlation(both, only_first, only_second, neither)

    def spread(one: float, other: float) -> float:
        return math.sqrt(max(0.0, one * one - 2.0 * phi * one * other + other * other))

    return p - q - spread(p - p_low, q_high - q), p - q + spread(p_high - p, q - q_low)


def _correlation(a: int, b: int, c: int, d: int) -> float:
    """Of the two outcomes, 0 where one never varies; with Newcombe's correction for continuity where it is positive."""
    margins = (a + b) * (c + d) * (a + c) * (b + d)
    if margins == 0:
        return 0.0
    excess = float(a * d - b * c)
    if excess > 0.0:
        excess = max(excess - (a + b + c + d) / 2.0, 0.0)
    return excess / math.sqrt(margins)


def _log_choose(n: int, k: np.ndarray) -> np.ndarray:
    """Logarithm of the binomial coefficients. Shape of k."""
    lgamma = np.vectorize(math.lgamma, otypes=[float])
    return np.asarray(math.lgamma(n + 1) - lgamma(k + 1) - lgamma(n - k + 1))
