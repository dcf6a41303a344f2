"""Sums over layers of eigenstrain for waves in the plane."""

import numpy as np
import pytest

from eigencontact.solvers.wave_layers import LayerSums, coefficients, plane_at

K = np.array([0.3, 1.0, 4.0])
SOURCE = np.random.default_rng(9).normal(size=(6, 1, K.size)) + 0j


def field(interfaces, source, depths, quantity="stress", nu=0.3):
    edges = np.asarray(interfaces, dtype=float)
    planes = [plane_at(edges, depth) for depth in depths]
    return LayerSums(edges, K, source, planes, coefficients(quantity, nu)).field()


def test_places_of_planes_among_interfaces():
    edges = np.array([0.0, 1.0, 3.0])
    assert plane_at(edges, 2.0).inside == ((1, 1.0),)
    assert dict(plane_at(edges, 1.0).inside) == {0: 0.5, 1: 0.5}
    assert plane_at(edges, 0.0).inside == ((0, 1.0),)
    assert plane_at(edges, 5.0).inside == ()
    assert plane_at(edges, 2.0).above == (1, 1.0)
    assert plane_at(edges, 5.0).below is None
    assert plane_at(edges + 1.0, 0.5).above is None


@pytest.mark.parametrize("quantity", ["displacement", "strain", "stress"])
def test_a_layer_may_be_cut_in_two(quantity):
    depths = [0.0, 0.5, 1.5, 2.5, 4.0]
    whole = field([1.0, 3.0], SOURCE, depths, quantity)
    halves = field([1.0, 2.1, 3.0], np.repeat(SOURCE, 2, axis=1), depths, quantity)
    np.testing.assert_allclose(halves, whole, rtol=0.0, atol=1e-13 * np.abs(whole).max())


@pytest.mark.parametrize("nu", [-0.5, 0.3, 0.5])
def test_the_surface_is_free_of_traction_and_depth_of_everything(nu):
    """Components zz, yz and xz vanish on the surface; all of them where exp(-kz) has decayed."""
    values = field([0.5, 1.0], SOURCE, [0.0, 200.0], nu=nu)
    largest = np.abs(values).max()
    assert np.abs(values[[2, 3, 4], 0]).max() < 1e-12 * largest
    assert np.abs(values[:, 1]).max() < 1e-12 * largest
