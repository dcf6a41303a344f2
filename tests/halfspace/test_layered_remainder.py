"""A smooth field on nodes against the closed integral of s / (2π (r² + s²)^(3/2)), whose response is exp(-ks)."""

import numpy as np

from eigencontact.halfspace.layered_remainder import SmoothField

SCALE, HALF = 0.7, (0.15, 0.1)
X, Y = np.linspace(-2.0, 2.0, 9), np.linspace(-1.0, 1.5, 6)


def response(names, kx, ky):
    """Displacement along z alone, at one depth."""
    decay = np.exp(-SCALE * np.hypot(kx, ky))
    return np.array([decay[None] * (name == "z") for name in names], dtype=complex)


FIELD = SmoothField(response, "p", "displacement", SCALE, SCALE, float(np.arcsinh(3.0 / SCALE)))
NODAL = FIELD.at(1.4)


def closed(x, y):
    """Integral over the rectangle about x, y: arctan(xy / (s d)) / 2π over its corners."""
    corners = [(i * j, x + i * HALF[0], y + j * HALF[1]) for i in (-1, 1) for j in (-1, 1)]
    return sum(
        sign * np.arctan(a * b / (SCALE * np.sqrt(a * a + b * b + SCALE**2))) for sign, a, b in corners
    ) / (2.0 * np.pi)  # fmt: skip


def test_integrals_over_cells_are_the_closed_ones():
    found, expected = NODAL.on_cells([2, 0], 0, X, Y, HALF), closed(X[None, :], Y[:, None])
    np.testing.assert_allclose(found[0], expected, rtol=0.0, atol=1e-10 * expected.max())
    assert np.abs(found[1]).max() < 1e-12 * expected.max()


def test_points_and_loads_give_the_same_integrals():
    table = NODAL.on_cells([2], 0, X, Y, HALF)[0]
    y, x = (values.ravel() for values in np.meshgrid(Y, X, indexing="ij"))
    np.testing.assert_allclose(NODAL.about_points([2], 0, x, y, HALF)[0], table.ravel(), rtol=1e-12)
    load = np.random.default_rng(0).normal(size=table.shape)
    moments = NODAL.moments(X, Y, HALF, load)[NODAL.parities[2]]
    np.testing.assert_allclose(np.vdot(NODAL.values[2, 0], moments), np.vdot(table, load), rtol=1e-11)
