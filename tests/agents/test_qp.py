"""The solvers agree with one another and with the conditions that define a minimum."""

import numpy as np
import pytest

from airhockey.agents.control.qp import make_solver
from airhockey.errors import ConfigurationError

EVERY = pytest.mark.parametrize("name", ["daqp", "osqp", "dual"])


def random_problem(rng, n, m, equalities=0):
    root = rng.normal(size=(n, n))
    rows, inside = rng.normal(size=(m, n)), rng.normal(size=n)
    lower, upper = rows @ inside - rng.uniform(0, 0.5, m), rows @ inside + rng.uniform(0, 0.5, m)
    lower[:equalities] = upper[:equalities] = rows[:equalities] @ inside
    return root @ root.T + np.eye(n), 3 * rng.normal(size=n), rows, lower, upper


@pytest.mark.parametrize("equalities", [0, 2])
def test_a_method_of_first_order_gives_the_same_answer(equalities):
    rng = np.random.default_rng(1)
    daqp, osqp = make_solver("daqp"), make_solver("osqp")
    for _ in range(20):
        problem = random_problem(rng, 4, 9, equalities)
        np.testing.assert_allclose(daqp.solve(*problem), osqp.solve(*problem), atol=1e-5)


@pytest.mark.parametrize("feasible", [True, False])
def test_the_packages_own_solver_gives_the_answers_of_daqp(feasible):
    rng = np.random.default_rng(3)
    daqp, dual = make_solver("daqp"), make_solver("dual")
    without = 0
    for _ in range(1500):
        n, m = rng.integers(1, 9), rng.integers(1, 17)
        hessian, gradient, rows, lower, upper = random_problem(rng, n, m, rng.integers(0, min(n, m) + 1))
        if not feasible:
            shift = rng.normal(size=m)
            lower, upper = lower + shift, upper + shift
        upper[(rng.random(m) < 0.2) & (upper > lower)] = np.inf
        answers = [solver.solve(hessian, gradient, rows, lower, upper) for solver in (daqp, dual)]
        assert (answers[0] is None) == (answers[1] is None)
        if answers[0] is None:
            without += 1
        else:
            np.testing.assert_allclose(answers[1], answers[0], rtol=1e-9, atol=1e-9)
    assert (without == 0) if feasible else (300 < without < 1400)


def test_rows_that_repeat_one_another_are_no_obstacle():
    rows = np.array([[1.0, 1.0], [2.0, 2.0], [-1.0, -1.0], [1.0, 1.0]])
    lower, upper = np.array([2.0, 4.0, -2.0, 1.0]), np.array([2.0, np.inf, 5.0, 9.0])
    x = make_solver("dual").solve(np.eye(2), np.zeros(2), rows, lower, upper)
    np.testing.assert_allclose(x, [1.0, 1.0], atol=1e-12)
    upper[3] = 1.9  # against the first
    assert make_solver("dual").solve(np.eye(2), np.zeros(2), rows, lower, upper) is None


@EVERY
def test_no_feasible_direction_descends(name):
    rng = np.random.default_rng(2)
    hessian, gradient, rows, lower, upper = random_problem(rng, 3, 6)
    x = make_solver(name).solve(hessian, gradient, rows, lower, upper)
    value = 0.5 * x @ hessian @ x + gradient @ x
    assert np.all(rows @ x <= upper + 1e-6) and np.all(rows @ x >= lower - 1e-6)
    others = x + 0.05 * rng.normal(size=(20000, 3))
    others = others[np.all((others @ rows.T <= upper) & (others @ rows.T >= lower), axis=1)]
    assert len(others) > 50
    assert np.all(0.5 * np.einsum("ij,jk,ik->i", others, hessian, others) + others @ gradient >= value - 1e-6)


@EVERY
def test_without_active_rows_the_answer_is_newtons(name):
    hessian, gradient = np.diag([1.0, 2.0]), np.array([1.0, -2.0])
    x = make_solver(name).solve(hessian, gradient, np.eye(2), np.full(2, -np.inf), np.full(2, np.inf))
    np.testing.assert_allclose(x, [-1.0, 1.0], atol=1e-6)


@EVERY
def test_contradicting_rows_have_no_answer(name):
    rows = np.array([[1.0, 0.0], [1.0, 0.0]])
    solve = make_solver(name).solve
    assert solve(np.eye(2), np.zeros(2), rows, np.array([1.0, -np.inf]), np.array([np.inf, 0.0])) is None
    assert solve(np.eye(2), np.zeros(2), rows, np.array([1.0, 0.0]), np.array([0.0, 0.0])) is None


def test_an_unknown_solver_is_named():
    with pytest.raises(ConfigurationError, match=r"gurobi.*daqp, dual, osqp"):
        make_solver("gurobi")
