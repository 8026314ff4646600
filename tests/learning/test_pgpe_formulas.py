"""PGPE's formulas: against finite differences, against what can be worked out by hand, and against MushroomRL."""

import numpy as np
import pytest

from airhockey.errors import ConfigurationError
from airhockey.learning.diverged import DivergedError
from airhockey.learning.pgpe.evolution import CmaSearch
from airhockey.learning.pgpe.hyperpolicy import Hyperpolicy
from airhockey.learning.pgpe.penalty_budget import PenaltyBudget
from airhockey.learning.pgpe.schedule import learning_rate
from airhockey.learning.pgpe.search import BASELINES, Pgpe, check_progress

MEAN, SIGMA = np.array([0.3, -1.2, 4.0]), np.array([0.5, 0.02, 3.0])
POLICY = Hyperpolicy(MEAN, np.log(SIGMA))
FREE = np.full(3, -1e9), np.full(3, 1e9)
TARGET = np.array([1.0, -1.15, -2.0])


def worth(theta: np.ndarray) -> np.ndarray:
    """A bowl with its top at TARGET, as wide in each direction as POLICY."""
    return -(((theta - TARGET) / SIGMA) ** 2).sum(axis=1)


def test_the_scores_are_the_derivatives_of_the_log_density():
    theta, step = np.array([0.9, -1.19, 1.0]), 1e-6
    by_mean, by_log_sigma = (score[0] for score in POLICY.scores(theta[None]))
    for k in range(3):
        nudge = step * np.eye(3)[k]
        up, down = (Hyperpolicy(MEAN + s * nudge, POLICY.log_sigma).log_density(theta) for s in (1, -1))
        assert by_mean[k] == pytest.approx((up - down) / (2 * step), rel=1e-5)
        up, down = (Hyperpolicy(MEAN, POLICY.log_sigma + s * nudge).log_density(theta) for s in (1, -1))
        assert by_log_sigma[k] == pytest.approx((up - down) / (2 * step), rel=1e-5, abs=1e-8)


def test_the_density_is_that_of_a_gaussian():
    """At μ, one σ wide: (2π)^(-1/2); one σ beside it e^(-1/2) of that."""
    one = Hyperpolicy(np.zeros(1), np.zeros(1))
    assert one.log_density(np.zeros(1)) == pytest.approx(-0.5 * np.log(2 * np.pi))
    assert one.log_density(np.ones(1)) == pytest.approx(-0.5 * np.log(2 * np.pi) - 0.5)


def test_fisher_is_the_variance_of_the_scores():
    scores = POLICY.scores(POLICY.sample(np.random.default_rng(0), 200_000))
    for score, fisher in zip(scores, POLICY.fisher(), strict=True):
        np.testing.assert_allclose((score**2).mean(axis=0), fisher, rtol=0.02)


def test_pairs_lie_on_either_side_of_the_mean():
    theta = POLICY.sample(np.random.default_rng(1), 5, symmetric=True)
    np.testing.assert_allclose(theta[0] + theta[1], 2 * MEAN)
    np.testing.assert_allclose(theta[2] + theta[3], 2 * MEAN)
    assert theta.shape == (5, 3)


@pytest.mark.parametrize("natural", [True, False])
def test_an_update_by_hand(natural):
    """Two samples one σ above and below, worth 3 and 1; b is their mean 2: Δμ = α·σ (natural) or α/σ, Δlog σ = 0."""
    search = Pgpe(Hyperpolicy(np.zeros(1), np.log([0.5])), np.array([-9.0]), np.array([9.0]), natural, "mean", False)
    search.tell(np.array([[0.5], [-0.5]]), np.array([3.0, 1.0]), rate=0.1)
    assert search.mean[0] == pytest.approx(0.1 * (0.5 if natural else 2.0))
    assert search.sigma[0] == pytest.approx(0.5)


def test_sigma_by_hand():
    """Worth 1 at two σ, 0 at μ, no baseline: ∇_log σ = (1·(4 − 1) + 0)/2 = 1.5; natural with α = 0.2 adds 0.15."""
    search = Pgpe(Hyperpolicy(np.zeros(1), np.log([0.5])), np.array([-9.0]), np.array([9.0]), True, "none", False)
    search.tell(np.array([[1.0], [0.0]]), np.array([1.0, 0.0]), rate=0.2)
    assert np.log(search.sigma[0] / 0.5) == pytest.approx(0.15)


def test_the_moving_baseline_is_the_average_of_what_came_before():
    search = Pgpe(Hyperpolicy(np.zeros(1), np.zeros(1)), *(np.array([x]) for x in (-9.0, 9.0)), True, "moving", False)
    search.tell(np.array([[1.0], [-1.0]]), np.array([2.0, 2.0]), rate=1.0)  # its own mean, 2: nothing moves
    assert search.mean[0] == 0.0
    search.tell(np.array([[1.0]]), np.array([5.0]), rate=0.1)  # b is still 2
    assert search.mean[0] == pytest.approx(0.3)
    assert search.moving == pytest.approx(0.8 * 2.0 + 0.2 * 5.0)


@pytest.mark.parametrize("natural", [True, False])
@pytest.mark.parametrize("baseline", BASELINES)
def test_the_estimate_is_the_gradient(natural, baseline):
    """J(ρ) = −Σ ((μ − t)² + σ²)/s²: its derivatives are −2 (μ − t)/s² and, in log σ, −2 σ²/s²."""
    search = Pgpe(POLICY, *FREE, natural=natural, baseline=baseline, normalize=False)
    theta = POLICY.sample(np.random.default_rng(2), 400_000)
    by_mean, by_log_sigma = search.gradient(theta, worth(theta))
    np.testing.assert_allclose(by_mean * SIGMA, -2 * (MEAN - TARGET) / SIGMA, atol=0.1)
    np.testing.assert_allclose(by_log_sigma, -2.0, atol=0.15)


def test_the_same_estimate_as_mushroomrls():
    from mushroom_rl.algorithms.policy_search import PGPE
    from mushroom_rl.distributions import GaussianDiagonalDistribution

    steps = []

    def optimizer(parameters, gradient):
        steps.append(gradient)
        return parameters + 0.01 * gradient

    theirs = PGPE.__new__(PGPE)  # without an environment
    theirs.distribution, theirs.optimizer = GaussianDiagonalDistribution(MEAN.copy(), SIGMA.copy()), optimizer
    ours = Pgpe(POLICY, *FREE, natural=False, baseline="optimal", normalize=False)
    random = np.random.default_rng(3)
    theta = ours.ask(random, 8)
    theirs._update(worth(theta), theta)
    by_mean, by_log_sigma = ours.gradient(theta, worth(theta))
    np.testing.assert_allclose(by_mean, steps[0][:3], rtol=1e-10)
    np.testing.assert_allclose(by_log_sigma, SIGMA * steps[0][3:], rtol=1e-9, atol=1e-12)  # theirs is by σ
    ours.tell(theta, worth(theta), rate=0.01)
    np.testing.assert_allclose(ours.mean, theirs.distribution.get_parameters()[:3], rtol=1e-12)


def test_both_find_the_top_of_the_bowl():
    """The same problem with a known answer, each with its own samples."""
    from mushroom_rl.algorithms.policy_search import PGPE
    from mushroom_rl.distributions import GaussianDiagonalDistribution

    unit = Hyperpolicy(np.zeros(2), np.log(np.full(2, 0.5)))
    top = np.array([0.8, -0.5])
    theirs = PGPE.__new__(PGPE)
    theirs.distribution = GaussianDiagonalDistribution(unit.mean.copy(), unit.sigma.copy())
    theirs.optimizer = lambda parameters, gradient: np.append(parameters[:2] + 0.05 * gradient[:2], parameters[2:])
    ours = Pgpe(unit, np.full(2, -9.0), np.full(2, 9.0), natural=False, normalize=False, sigma_share=0.0)
    random = np.random.default_rng(4)
    for _ in range(150):
        for tell in (
            lambda theta, values: ours.tell(theta, values, 0.05),
            lambda theta, values: theirs._update(values, theta),
        ):
            theta = unit.sigma * random.standard_normal((16, 2))
            theta += ours.mean if tell.__code__.co_names[0] == "ours" else theirs.distribution.get_parameters()[:2]
            tell(theta, -((theta - top) ** 2).sum(axis=1))
    np.testing.assert_allclose(ours.mean, top, atol=0.08)
    np.testing.assert_allclose(theirs.distribution.get_parameters()[:2], top, atol=0.08)


@pytest.mark.parametrize("symmetric", [False, True])
def test_scale_does_not_matter_to_the_natural_gradient_of_normalized_returns(symmetric):
    """Parameters of very different size are found at one learning rate, whatever the reward's size."""
    search = Pgpe(POLICY, *FREE, symmetric=symmetric)
    random = np.random.default_rng(5)
    for _ in range(120):
        theta = search.ask(random, 20)
        search.tell(theta, 1e6 * worth(theta), rate=1.0)
    np.testing.assert_allclose((search.mean - TARGET) / SIGMA, 0.0, atol=0.25)
    assert (search.sigma < SIGMA).all()


def test_the_mean_stays_within_its_bounds():
    search = Pgpe(POLICY, MEAN - 0.1 * SIGMA, MEAN + 0.1 * SIGMA)
    theta = search.ask(np.random.default_rng(6), 10)
    search.tell(theta, worth(theta), rate=50.0)
    assert (np.abs(search.mean - MEAN) <= 0.1 * SIGMA + 1e-12).all()


def test_equal_returns_teach_nothing():
    search = Pgpe(POLICY, *FREE)
    search.tell(search.ask(np.random.default_rng(7), 6), np.ones(6), rate=1.0)
    np.testing.assert_array_equal(search.mean, MEAN)
    np.testing.assert_array_equal(search.sigma, np.exp(np.log(SIGMA)))


def test_cma_finds_the_top_too_and_depends_on_its_generators_alone():
    found = []
    for _ in range(2):
        np.random.seed(None)  # which must not matter
        search = CmaSearch(MEAN, SIGMA, *FREE, count=10)
        np.testing.assert_allclose(search.mean, MEAN)
        for number in range(60):
            theta = search.ask(np.random.default_rng([8, number]), 10)
            search.tell(theta, worth(theta), rate=0.0)
        found.append(search.mean)
    np.testing.assert_allclose((found[0] - TARGET) / SIGMA, 0.0, atol=1e-2)
    np.testing.assert_array_equal(found[0], found[1])


def test_a_budget_is_held_where_the_best_would_break_it():
    """Worth −(x − 2)², penalty max(0, x − 1), budget 0.1: the answer is about 1.1, and without a budget 2."""
    for budget, expected in ((0.1, 1.1), (None, 2.0)):
        search = Pgpe(Hyperpolicy(np.zeros(1), np.log([0.1])), *(np.array([x]) for x in (-9.0, 9.0)), sigma_share=0.0)
        constraint = PenaltyBudget(budget, rate=0.5)
        random, means = np.random.default_rng(9), []
        for _ in range(400):
            theta = search.ask(random, 12)
            penalties = np.maximum(0.0, theta[:, 0] - 1.0)
            search.tell(theta, constraint.values(-((theta[:, 0] - 2.0) ** 2), penalties), rate=0.5)
            constraint.update(penalties)
            means.append(search.mean[0])
        assert np.mean(means[-200:]) == pytest.approx(expected, abs=0.12)


def test_the_multiplier_rises_by_what_is_over_the_budget_and_never_below_zero():
    constraint = PenaltyBudget(0.5, rate=2.0)
    constraint.update(np.array([1.0, 2.0]))
    assert constraint.multiplier == pytest.approx(2.0)
    constraint.update(np.zeros(2))
    constraint.update(np.zeros(2))
    constraint.update(np.zeros(2))
    assert constraint.multiplier == 0.0


@pytest.mark.parametrize(
    ("schedule", "expected"), [("constant", 2.0), ("linear", 1.0), ("sqrt", 2.0 / np.sqrt(6.0)), ("cosine", 1.0)]
)
def test_learning_rates_half_way(schedule, expected):
    assert learning_rate(schedule, 2.0, 5, 10) == pytest.approx(expected)
    assert learning_rate(schedule, 2.0, 0, 10) == 2.0


def test_an_unknown_schedule_is_named():
    with pytest.raises(ConfigurationError, match="'step'"):
        learning_rate("step", 1.0, 0, 1)


@pytest.mark.parametrize(
    ("factor", "value", "message"),
    [(1.0, np.inf, "not finite"), (1.0, np.nan, "not finite"), (1e-4, 0.0, "collapsed"), (1e3, 0.0, "exploded")],
)
def test_a_search_that_goes_astray_is_stopped(factor, value, message):
    search = Pgpe(Hyperpolicy(MEAN, np.log(factor * SIGMA)), *FREE)
    with pytest.raises(DivergedError, match=message):
        check_progress(search, SIGMA, np.array([1.0, value]))


def test_the_thesis_updates_sigma_itself():
    """dσ = α 1/N Σ (J − b) ((θ − μ)² − σ²)/σ, written out."""
    theta = POLICY.sample(np.random.default_rng(5), 40)
    values = worth(theta)
    search = Pgpe(POLICY, *FREE, natural=False, baseline="mean", normalize=False, sigma_rule="thesis")
    search.tell(theta, values, 1e-4)
    by_hand = (((theta - MEAN) ** 2 - SIGMA**2) / SIGMA * (values - values.mean())[:, None]).mean(axis=0)
    np.testing.assert_allclose(search.sigma, SIGMA + 1e-4 * by_hand, rtol=1e-12)


def test_a_step_that_leaves_no_sigma_is_said():
    search = Pgpe(POLICY, *FREE, natural=False, baseline="mean", normalize=False, sigma_rule="thesis")
    theta = MEAN + SIGMA * np.array([[0.0], [0.0], [3.0]])
    with pytest.raises(DivergedError, match="--learning-rate"):
        search.tell(theta, np.array([1.0, 1.0, 0.0]), 1e3)
