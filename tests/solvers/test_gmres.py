"""GMRES by itself: against dense solutions, its count of applications, singular and stagnant operators, extremes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from close import close
from eigencontact.solvers.gmres import gmres


class Counted:
    """A matrix that counts its applications."""

    def __init__(self, matrix):
        self.matrix, self.count = np.asarray(matrix, dtype=float), 0

    def __call__(self, vector):
        self.count += 1
        return self.matrix @ vector


def shifted(n, spread, seed=0):
    """Unsymmetric and well conditioned: one plus a random part."""
    return np.eye(n) + spread / np.sqrt(n) * np.random.default_rng(seed).normal(size=(n, n))


@pytest.mark.parametrize("restart", [3, 10, 50, 200])
def test_equals_the_dense_solution(restart):
    operator, b = Counted(shifted(60, 0.5)), np.random.default_rng(1).normal(size=60)
    found = gmres(operator, b, bound=1e-11, max_iterations=400, restart=restart)
    assert np.linalg.norm(b - operator.matrix @ found) <= 1.001e-11
    assert found == close(np.linalg.solve(operator.matrix, b), abs=1e-10)


def test_watch_hears_the_norm_of_the_true_residual_fall():
    """Of every cycle; the last of them is that of the answer."""
    matrix, b, heard = shifted(40, 0.6), np.random.default_rng(2).normal(size=40), []
    found = gmres(lambda v: matrix @ v, b, bound=1e-10, max_iterations=200, restart=15, watch=heard.append)
    assert np.all(np.diff(heard) <= 1e-15)
    assert heard[0] < np.linalg.norm(b)
    assert heard[-1] == close(np.linalg.norm(b - matrix @ found), rel=1e-3)


@pytest.mark.parametrize("kinds", [1, 2, 5])
def test_as_many_applications_as_different_eigenvalues(kinds):
    operator = Counted(np.diag(np.repeat(np.linspace(1.0, 9.0, kinds), 12)))
    b = np.random.default_rng(3).normal(size=12 * kinds)
    found = gmres(operator, b, bound=1e-12, max_iterations=100)
    assert found == close(b / np.diag(operator.matrix), abs=1e-11)
    assert operator.count <= kinds + 1  # the last one finds that nothing is left


@pytest.mark.parametrize(("restart", "most"), [(50, 12), (5, 14), (4, 14), (1, 23)])
def test_no_more_applications_than_allowed(restart, most):
    """Twelve in cycles, and one for the residual before every further cycle."""
    operator, b = Counted(shifted(80, 0.9)), np.ones(80)
    found = gmres(operator, b, bound=0.0, max_iterations=12, restart=restart)
    assert operator.count <= most
    assert np.linalg.norm(b - operator.matrix @ found) < np.linalg.norm(b)


@pytest.mark.parametrize(("bound", "allowed", "b"), [(1.0, 9, 0.1), (0.0, 9, 0.0), (1e-9, 0, 1.0)])
def test_nothing_is_done_where_nothing_is_asked_or_allowed(bound, allowed, b):
    operator = Counted(np.eye(4))
    assert not gmres(operator, np.full(4, b), bound=bound, max_iterations=allowed).any()
    assert operator.count == 0


def test_a_singular_operator_with_an_answer_finds_it():
    rng = np.random.default_rng(4)
    basis = np.linalg.qr(rng.normal(size=(30, 30)))[0]
    matrix = basis @ np.diag([0.0] * 5 + list(rng.uniform(1, 3, 25))) @ basis.T
    b = matrix @ rng.normal(size=30)
    found = gmres(lambda v: matrix @ v, b, bound=1e-11, max_iterations=100)
    assert np.linalg.norm(b - matrix @ found) < 1e-10


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("restart", [4, 50])
@pytest.mark.parametrize("symmetric", [True, False])
def test_a_singular_operator_without_an_answer_leaves_the_part_that_it_cannot_reach(seed, restart, symmetric):
    """Finite, no worse than the start, and of moderate size: rounding must not send the answer along the null space."""
    rng = np.random.default_rng(seed)
    basis = np.linalg.qr(rng.normal(size=(20, 20)))[0]
    other = basis if symmetric else np.linalg.qr(rng.normal(size=(20, 20)))[0]
    matrix = basis @ np.diag([0.0] * 3 + list(rng.uniform(1, 2, 17))) @ other.T
    b = rng.normal(size=20)
    found = gmres(lambda v: matrix @ v, b, bound=1e-12, max_iterations=200, restart=restart)
    left, least = np.linalg.norm(b - matrix @ found), np.linalg.norm(b - matrix @ np.linalg.pinv(matrix) @ b)
    assert np.isfinite(found).all()
    assert left <= np.linalg.norm(b) * (1 + 1e-12)
    assert np.abs(found).max() < 1e6
    if symmetric and restart > 20:
        assert left == close(least, rel=1e-6)


def test_an_operator_that_answers_nothing_gives_nothing():
    operator = Counted(np.zeros((6, 6)))
    assert not gmres(operator, np.ones(6), bound=1e-9, max_iterations=50).any()
    assert operator.count <= 2


@pytest.mark.parametrize(("restart", "solved"), [(8, True), (7, False), (3, False)])
def test_stagnation_ends_the_search(restart, solved):
    """A shift around a ring: the residual stays as it is until all of the space is known."""
    operator, b = Counted(np.roll(np.eye(8), 1, axis=0)), np.eye(8)[0]
    found = gmres(operator, b, bound=1e-12, max_iterations=1000, restart=restart)
    assert (np.linalg.norm(b - operator.matrix @ found) < 1e-12) == solved
    assert operator.count <= restart + 1


def test_a_bound_below_rounding_does_not_run_forever():
    operator, b = Counted(shifted(50, 0.5)), np.random.default_rng(5).normal(size=50)
    found = gmres(operator, b, bound=0.0, max_iterations=10_000)
    assert np.linalg.norm(b - operator.matrix @ found) < 1e-13 * np.linalg.norm(b)
    assert operator.count < 500


@pytest.mark.parametrize("size", [1e-150, 1e-30, 1e30, 1e150])
def test_no_size_is_special(size):
    matrix, b = shifted(30, 0.5), np.random.default_rng(6).normal(size=30)
    expected = gmres(lambda v: matrix @ v, b, bound=1e-9, max_iterations=100)
    found = gmres(lambda v: matrix @ v, size * b, bound=1e-9 * size, max_iterations=100)
    assert found == close(size * expected, rel=1e-12, abs=0.0)
    stiff = gmres(lambda v: size * (matrix @ v), b, bound=1e-9, max_iterations=100)
    assert stiff == close(expected / size, rel=1e-12, abs=0.0)


@settings(max_examples=40, deadline=None)
@given(n=st.integers(1, 25), seed=st.integers(0, 10**6), restart=st.integers(1, 30), spread=st.floats(0.0, 3.0))
def test_the_residual_never_grows(n, seed, restart, spread):
    matrix, b = shifted(n, spread, seed), np.random.default_rng(seed + 1).normal(size=n)
    found = gmres(lambda v: matrix @ v, b, bound=1e-10, max_iterations=40, restart=restart)
    assert np.linalg.norm(b - matrix @ found) <= np.linalg.norm(b) * (1 + 1e-12)
