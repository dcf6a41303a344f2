"""Means over a neighbourhood: against the sum itself, of a constant, of what never falls."""

import numpy as np
import pytest

from eigencontact.solvers.neighbourhood import Neighbourhood, reach_of

EDGES, RADIUS = (1.0, 0.5, 1.5), 2.2


@pytest.fixture(params=[(5, 6, 7), (1, 9, 1), (3, 2, 4)])
def cells(request):
    return np.random.default_rng(0).random(request.param) > 0.3


def test_means_are_the_weighted_sums(cells):
    about = Neighbourhood(cells, EDGES, RADIUS)
    places = np.argwhere(cells) * EDGES
    squared = np.sum((places[:, None] - places[None]) ** 2, axis=2)
    weight = np.maximum(1 - squared / RADIUS**2, 0) ** 2
    values = np.random.default_rng(1).random((2, len(places)))
    np.testing.assert_allclose(about.means(values), values @ (weight / weight.sum(axis=1, keepdims=True)).T, rtol=1e-13)
    np.testing.assert_allclose(about.means(np.full((1, len(places)), 0.3)), 0.3, rtol=1e-13)


def test_the_bell_ends_at_its_radius_without_rounding_beyond():
    line = np.zeros((1, 1, 21))
    line[0, 0, 10] = 1.0
    found = Neighbourhood(np.ones(line.shape, dtype=bool), (1.0, 1.0, 1.0), 3.0).means(line.reshape(1, -1))[0]
    assert np.flatnonzero(found).tolist() == [8, 9, 10, 11, 12]
    assert reach_of(3.0, (1.0, 1.4, 3.0)) == (2, 2, 0)


def test_a_radius_within_a_cell_changes_nothing():
    values = np.random.default_rng(2).random((1, 8))
    np.testing.assert_array_equal(Neighbourhood(np.ones((2, 2, 2), dtype=bool), EDGES, 0.5).means(values), values)
