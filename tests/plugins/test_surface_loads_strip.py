"""Uniformly loaded strips: against line forces, Hooke's law, long rectangles, and their limits at the edges."""

import numpy as np
import pytest

from close import close
from eigencontact.core.tensors import from_mandel
from eigencontact.plugin import COMPONENTS, Material
from eigencontact_plugins.surface_loads import PressureLoad, ShearLoadX, ShearLoadY
from eigencontact_verification.oracles.line_contact import stress_under

LOADS = (PressureLoad(), ShearLoadX(), ShearLoadY())
NU, E = 0.3, 2.6  # G = 1
BODY = Material(young_modulus=E, poisson_ratio=NU)
A = 0.7
STRIP = (A, np.inf)
X = np.array([-2.1, -0.7, -0.2, 0.0, 0.5, 1.3])


def stress(load, x, z, widths=STRIP):
    """Plain components xx, yy, zz, yz, xz, xy."""
    x = np.asarray(x, dtype=float)
    return from_mandel(load.stress(COMPONENTS, x, np.zeros_like(x), z, widths, BODY))


def displacement(load, x, z, widths=STRIP):
    x = np.asarray(x, dtype=float)
    return load.displacement(("x", "y", "z"), x, np.zeros_like(x), z, widths, BODY)


@pytest.mark.parametrize("z", [0.05, 0.6, 3.0])
def test_stress_is_that_of_line_forces_in_plane_strain(z):
    for load, (p, q) in ((LOADS[0], (1.0, 0.0)), (LOADS[1], (0.0, 1.0))):
        xx, yy, zz, yz, xz, xy = stress(load, X, z)
        expected = [stress_under(lambda s, p=p: p + 0 * s, lambda s, q=q: q + 0 * s, x, z, (-A, A)) for x in X]
        np.testing.assert_allclose(np.transpose([xx, zz, xz]), expected, rtol=0, atol=1e-9)
        np.testing.assert_allclose(yy, NU * (xx + zz), rtol=0, atol=1e-14)
        assert not np.any([yz, xy])


def test_antiplane_strip_is_that_of_line_forces():
    """A line force along y has the displacement -ln(r) / (π G) along it."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    s, w = A * nodes, A * weights
    z = 0.4
    xx, yy, zz, yz, xz, xy = stress(LOADS[2], X, z)
    r2 = (X[:, None] - s) ** 2 + z * z
    np.testing.assert_allclose(xy, -((X[:, None] - s) / r2) @ w / np.pi, rtol=0, atol=1e-10)
    np.testing.assert_allclose(yz, -(z / r2) @ w / np.pi, rtol=0, atol=1e-10)
    assert not np.any([xx, yy, zz, xz])


@pytest.mark.parametrize("load", LOADS, ids=lambda load: load.key)
def test_strain_of_the_displacement_gives_the_stress(load):
    x, z, h = X, 0.6, 1e-4
    d_x = (displacement(load, x + h, z) - displacement(load, x - h, z)) / (2 * h)
    d_z = (displacement(load, x, z + h) - displacement(load, x, z - h)) / (2 * h)
    volume = d_x[0] + d_z[2]
    wave = 2 * NU / (1 - 2 * NU) * volume
    expected = [wave + 2 * d_x[0], wave, wave + 2 * d_z[2], d_z[1], d_z[0] + d_x[2], d_x[1]]
    np.testing.assert_allclose(stress(load, x, z), expected, rtol=0, atol=1e-7)


def test_surface_displacement_up_to_its_constant():
    """Normal by pressure, and along x by shear, are one curve; pressure and shear jump by opposite amounts."""
    x = np.array([-3.0, -0.1, 0.4, 1.9])
    curve = -(2 * (1 - NU**2) / (np.pi * E)) * ((x + A) * np.log(np.abs(x + A)) - (x - A) * np.log(np.abs(x - A)))
    for load, component in ((LOADS[0], 2), (LOADS[1], 0)):
        difference = displacement(load, x, 0.0)[component] - curve
        np.testing.assert_allclose(difference, difference[0], rtol=0, atol=1e-14)
    jump = (1 - 2 * NU) * (1 + NU) / (2 * E) * 2 * A
    assert displacement(LOADS[0], [-5.0, 5.0], 0.0)[0] == close(np.array([jump, -jump]), rel=1e-13)
    assert displacement(LOADS[1], [-5.0, 5.0], 0.0)[2] == close(np.array([-jump, jump]), rel=1e-13)


@pytest.mark.parametrize(("load", "order"), list(zip(LOADS, [(1, 1), (2, 1), (2, 2)], strict=True)))
def test_long_rectangles_tend_to_the_strip(load, order):
    """Stress, and differences of displacement: what the ends displace outward falls with width by length alone."""
    errors = []
    for b in (40.0, 80.0, 160.0):
        moved = displacement(load, X, 0.3) - displacement(load, X, 0.3, (A, b))
        parts = [stress(load, X, 0.3) - stress(load, X, 0.3, (A, b)), moved - moved[:, :1]]
        errors.append([float(np.abs(part).max()) for part in parts])
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, np.broadcast_to(order, (2, 2)), atol=0.05)
    assert np.max(errors[-1]) < 5e-3


def test_edges_and_lattices():
    """On an edge what jumps takes the mean of both sides; a lattice gives the values of points."""
    inside, edge, outside = (stress(LOADS[0], [x], 0.0)[:, 0] for x in (0.2, A, 0.9))
    np.testing.assert_allclose(inside[[0, 1, 2]], [-1.0, -2 * NU, -1.0], rtol=0, atol=1e-15)
    assert not outside.any()
    np.testing.assert_allclose(edge, 0.5 * inside, rtol=0, atol=1e-15)
    tension = stress(LOADS[1], [-A, A], 0.0)[0]
    assert np.all(np.isfinite(tension))
    assert tension[1] < -10.0 < 10.0 < tension[0]  # logarithmically infinite
    for z in (0.0, 0.4):
        table = LOADS[1].sample("stress", COMPONENTS, X, np.array([-1.0, 0.0]), z, STRIP, BODY)
        np.testing.assert_array_equal(from_mandel(table)[:, 1], stress(LOADS[1], X, z))
        np.testing.assert_array_equal(table[:, 0], table[:, 1])


def test_far_points_and_cells_of_any_size():
    """Far away the strip is its line force, to round-off; lengths of 1 nm and 1 m give the same stress."""
    far = 1e7
    assert stress(LOADS[0], [far], far)[2] == close(np.array([-(2 / np.pi) * 2 * A * far**3 / (2 * far**2) ** 2]))
    unit = 2.0**-30
    small = stress(LOADS[1], X * unit, 0.4 * unit, (A * unit, np.inf))
    np.testing.assert_array_equal(small, stress(LOADS[1], X, 0.4))
    moved = displacement(LOADS[0], X * unit, 0.4 * unit, (A * unit, np.inf))
    np.testing.assert_array_equal(moved, unit * displacement(LOADS[0], X, 0.4))
