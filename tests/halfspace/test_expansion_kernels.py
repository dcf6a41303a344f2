"""Biharmonic polynomials, moments of sources, and the tree of points."""

from math import comb

import numpy as np
import pytest

pytest.importorskip("numba")
from eigencontact.halfspace.expansion_kernels import grow, moments, polynomials

X, Y, Z = np.random.default_rng(4).uniform(-1.0, 1.0, (3, 20))
R2 = X**2 + Y**2 + Z**2


@pytest.mark.parametrize("degree", [0, 1, 2, 5, 11])
def test_harmonics_have_racahs_norm_and_all_biharmonics_are_there(degree):
    values = polynomials(X, Y, Z, degree)
    assert len(values) == (degree + 1) ** 2 + max(degree - 1, 0) ** 2
    for k in range(degree + 1):
        np.testing.assert_allclose((values[k * k : (k + 1) ** 2] ** 2).sum(axis=0), R2**k, rtol=1e-12)
    last = values[(degree + 1) ** 2 :]
    np.testing.assert_allclose(last, R2 * values[: len(last)], rtol=1e-14)
    # As many are independent as polynomials have biharmonic ones: those of a degree without those of four less.
    count = comb(degree + 3, 3) - (comb(degree - 1, 3) if degree >= 4 else 0)
    many = polynomials(*np.random.default_rng(1).normal(size=(3, 400)), degree)
    assert np.linalg.matrix_rank(many) == len(many) == count


def test_moments_sum_over_sources():
    weights, spreads = np.random.default_rng(5).normal(size=(2, X.size))
    first, second = moments(X, Y, Z, weights, spreads, 3)
    values = polynomials(X, Y, Z, 3)[:16]
    degree = np.repeat(np.arange(4), 2 * np.arange(4) + 1)[:, None]
    np.testing.assert_allclose(first, values @ weights, atol=1e-13)
    np.testing.assert_allclose(second, (values * (R2 / (2 * degree + 3) + spreads)) @ weights, atol=1e-13)


def test_a_tree_parts_its_points():
    points = np.random.default_rng(6).normal(size=(3, 500))
    order, nodes, ranges, parents, children, depths = grow(points, 40, 16)
    assert sorted(order) == list(range(500))
    assert depths[-1] == len(nodes)
    for node, (first, stop) in enumerate(ranges):
        away = np.linalg.norm(points[:, order[first:stop]].T - nodes[node, :3], axis=1)
        assert away.max() <= nodes[node, 3] * (1 + 1e-12)
        assert nodes[node, 4] == (stop - first >= 40)
        if children[node, 0] < 0:
            assert stop - first <= 16
        else:
            low, high = (tuple(ranges[child]) for child in children[node])
            assert (low[0], low[1], high[1]) == (first, high[0], stop)
            assert all(parents[child] == node for child in children[node])
