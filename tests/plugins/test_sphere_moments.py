"""Potentials of polynomial densities over a ball, against quadrature and the closed forms of a uniform ball."""

import numpy as np
import pytest

from eigencontact_plugins.shapes.sphere import SphericalInclusion

BALL = SphericalInclusion(center=(0.3, -0.2, 2.0), radius=1.5)
FAR = tuple(np.array([value]) for value in (3.0, 4.0, 5.0))
N = 4


def each(order, count=35):
    """Weights that give one derivative of every density."""
    return [order], np.eye(count)[:, :, None]


def test_a_uniform_density_gives_the_closed_forms():
    rng = np.random.default_rng(1)
    x, y, z = rng.normal(size=(3, 40)) * 1.2
    orders = [(1, 0, 0), (2, 0, 0), (0, 0, 2), (1, 1, 1), (2, 1, 1)]
    np.testing.assert_allclose(BALL.phi_moments(0, orders, x, y, z + 2)[0], BALL.phi(orders, x, y, z + 2), atol=1e-13)
    for name, orders in (("psi", [(3, 0, 0), (1, 1, 1), (2, 1, 1), (1, 2, 2)]), ("chi", [(2, 1, 0), (2, 1, 1)])):
        weights = {name: (orders, np.eye(len(orders))[:, None, :])}
        found = BALL.moment_sums(0, weights, x, y, np.abs(z), image=name == "chi")
        expected = getattr(BALL, name)(orders, x, y, np.abs(z))
        np.testing.assert_allclose(found, expected, atol=1e-13)


@pytest.mark.parametrize("name", ["phi", "psi"])
def test_potentials_outside_by_quadrature(name):
    points, weights = BALL.density_rule((14, 24, 24))
    offsets = np.array(FAR).T - points
    distance = np.linalg.norm(offsets, axis=1)
    product = offsets.prod(axis=1)
    kernel = -15 * product / distance**7 if name == "phi" else 3 * product / distance**5  # derivatives by x, y, z
    expected = BALL.densities(N, *points.T) @ (weights * kernel)
    found = BALL.moment_sums(N, {name: each((1, 1, 1))}, *FAR, image=False)[:, 0]
    np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(expected).max())


def test_laplacians_inside():
    """That of Phi is -4 pi times the density, that of Psi twice Phi."""
    x, y, z = np.array([0.4, 0.8]), np.array([0.4, -0.4]), np.array([1.7, 2.7])
    second = [(2, 0, 0), (0, 2, 0), (0, 0, 2)]
    laplacian = BALL.phi_moments(N, second, x, y, z).sum(axis=1)
    np.testing.assert_allclose(laplacian, -4 * np.pi * BALL.densities(N, x, y, z), atol=1e-12)
    orders = [tuple(np.add((1, 0, 2), more)) for more in second]
    psi = BALL.moment_sums(N, {"psi": (orders, np.repeat(np.eye(35)[:, :, None], 3, axis=2))}, x, y, z, image=False)
    np.testing.assert_allclose(psi, 2 * BALL.phi_moments(N, [(1, 0, 2)], x, y, z)[:, 0], atol=1e-12)


def test_the_image_is_the_mirrored_region():
    x, y, z = np.array([0.1, 2.0]), np.array([0.7, -1.0]), np.array([0.0, 0.6])
    found = BALL.moment_sums(N, {"phi": each((1, 0, 1))}, x, y, z, image=True)
    expected = -BALL.phi_moments(N, [(1, 0, 1)], x, y, -z)[:, 0]
    np.testing.assert_allclose(found, expected, atol=1e-13)


def test_the_boundary_is_the_mean_of_both_sides():
    touching = SphericalInclusion(center=(0.0, 0.0, 1.0), radius=1.0)
    r = np.array([1 - 1e-9, 1.0, 1 + 1e-9])
    inner, at, outer = touching.phi_moments(2, [(2, 0, 0)], 0.6 * r, 0.0 * r, 1.0 + 0.8 * r)[:, 0].T
    np.testing.assert_allclose(at, 0.5 * (inner + outer), atol=1e-7)
    assert np.abs(inner - outer).max() > 1.0
