"""Tests of significance against their definitions, by enumeration, and against published figures."""

import itertools
import math
from fractions import Fraction

import pytest

from airhockey.evaluator.judging.statistics import compare_pairs, compare_samples, fisher, holm, mcnemar


@pytest.mark.parametrize(("only_first", "only_second"), [(0, 0), (0, 1), (3, 3), (1, 8), (9, 2), (12, 0)])
def test_mcnemar_is_the_share_of_coin_tosses_at_least_as_lopsided(only_first: int, only_second: int) -> None:
    tosses = only_first + only_second
    lopsided = abs(only_first - only_second)
    extreme = sum(abs(2 * sum(heads) - tosses) >= lopsided for heads in itertools.product((0, 1), repeat=tosses))
    assert mcnemar(only_first, only_second) == pytest.approx(extreme / 2**tosses, rel=1e-9)


@pytest.mark.parametrize(
    "table", [(3, 1, 1, 3), (8, 2, 1, 5), (0, 5, 4, 1), (7, 0, 0, 7), (2, 3, 4, 6), (5, 0, 5, 0), (1, 9, 11, 3)]
)
def test_fisher_is_the_share_of_shuffles_at_most_as_likely(table: tuple[int, int, int, int]) -> None:
    """With exact fractions, over every way to deal the successes to the two samples."""
    a, b, c, d = table
    successes, total = a + c, a + b + c + d
    ways = {
        k: math.comb(a + b, k) * math.comb(c + d, successes - k) for k in range(successes + 1) if successes - k >= 0
    }
    likely = sum(count for count in ways.values() if count <= ways[a])
    assert fisher(*table) == pytest.approx(float(Fraction(likely, math.comb(total, successes))), rel=1e-9)


def test_fisher_on_the_lady_tasting_tea() -> None:
    """Fisher 1935: three of four cups right has the two-sided p-value 34/70."""
    assert fisher(3, 1, 1, 3) == pytest.approx(34 / 70)


def test_large_numbers_neither_overflow_nor_vanish() -> None:
    assert mcnemar(50_000, 50_000) == pytest.approx(1.0)
    assert 0.0 <= mcnemar(60_000, 40_000) < 1e-300
    assert 0.0 < fisher(5_100, 4_900, 4_900, 5_100) < 0.01
    assert fisher(500, 500, 500, 500) == pytest.approx(1.0)


def test_the_interval_of_two_samples_is_newcombes() -> None:
    """Newcombe 1998, table II, method 10: 56/70 against 48/80, and 9/10 against 3/10."""
    difference = compare_samples(56, 70, 48, 80)
    assert difference.estimate == pytest.approx(0.2)
    assert (difference.low, difference.high) == (pytest.approx(0.0524, abs=5e-5), pytest.approx(0.3339, abs=5e-5))
    difference = compare_samples(9, 10, 3, 10)
    assert (difference.low, difference.high) == (pytest.approx(0.1705, abs=5e-5), pytest.approx(0.8090, abs=5e-5))


def test_the_interval_of_pairs_is_newcombes() -> None:
    """Newcombe 1998 (paired), table III, method 10: 36, 12, 2 and 0 of 50 pairs."""
    difference = compare_pairs(36, 12, 2, 0)
    assert difference.estimate == pytest.approx(0.2)
    assert (difference.low, difference.high) == (pytest.approx(0.0569, abs=5e-5), pytest.approx(0.3404, abs=5e-5))


@pytest.mark.parametrize("pairs", [(10, 0, 0, 0), (0, 0, 0, 7), (0, 9, 0, 0), (0, 0, 5, 0), (5, 0, 0, 5), (1, 0, 0, 0)])
def test_intervals_hold_the_estimate_and_stay_within_what_is_possible(pairs: tuple[int, int, int, int]) -> None:
    difference = compare_pairs(*pairs)
    assert -1.0 - 1e-12 <= difference.low <= difference.estimate <= difference.high <= 1.0 + 1e-12
    both, first, second, _ = pairs
    samples = compare_samples(both + first, sum(pairs), both + second, sum(pairs))
    assert -1.0 - 1e-12 <= samples.low <= samples.estimate <= samples.high <= 1.0 + 1e-12


def test_exchanging_the_two_turns_the_difference_round() -> None:
    there, back = compare_pairs(30, 12, 5, 3), compare_pairs(30, 5, 12, 3)
    assert (there.estimate, there.low, there.high) == pytest.approx((-back.estimate, -back.high, -back.low))
    assert there.p_value == back.p_value
    there, back = compare_samples(12, 20, 9, 33), compare_samples(9, 33, 12, 20)
    assert (there.estimate, there.low, there.high) == pytest.approx((-back.estimate, -back.high, -back.low))
    assert there.p_value == pytest.approx(back.p_value)


def test_holm_multiplies_the_smallest_most_and_keeps_the_order() -> None:
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.5, 0.9]) == pytest.approx([1.0, 1.0])
    assert holm([0.2]) == [0.2]
    assert holm([]) == []
