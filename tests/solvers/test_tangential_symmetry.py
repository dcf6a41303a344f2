"""Exact properties of frictional contact: turns, mirrors, scale, like bodies, vanishing Poisson's ratio."""

from itertools import pairwise

import numpy as np
import pytest

from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from solvers.frictional import Sphere, elastic

#: P, Q_x, Q_y over μP, M over μP a: pressed, sheared, twisted, and back in part.
COURSE = [(0.6, 0.0, 0.0, 0.0), (1.0, 0.3, 0.1, 0.1), (1.0, 0.5, 0.4, 0.2), (0.8, 0.1, 0.5, -0.1)]
#: Rounding may send the iteration another way; answers to this tolerance still agree to 1e-10.
FINE = 1e-11


def ellipse(grid, turned=False):
    """Separation without any symmetry but that of the plane z = 0: an ellipsoid beside the middle, with a ridge."""
    y, x = grid.axes()
    u, v = (y, -x) if turned else (x, y)
    return 0.5 * (u - 0.07) ** 2 + 0.8 * (v + 0.03) ** 2 + 0.03 * np.cos(3 * u + 2 * v)


def follow(s, map_shear=lambda qx, qy, m: (qx, qy, m), unit=1.0):
    """Follow the course; loads over the unit."""
    for load, *shear in COURSE:
        qx, qy, moment = map_shear(*shear)
        force = s.friction * load * s.load
        s.to(load, tangential_load_x=qx * force, tangential_load_y=qy * force, torsion_moment=moment * force * unit)
    return s.last


def same(found, expected, size):
    np.testing.assert_allclose(found, expected, atol=1e-10 * size, rtol=0)


@pytest.mark.parametrize("coupling", [pytest.param("partial", marks=pytest.mark.slow), "full"])
def test_a_quarter_turn_changes_nothing(coupling):
    """All fields to 1e-10: (x, y) -> (-y, x), shear and slip turned along, on cells that are not square."""
    grids = Grid(nx=28, ny=23, dx=0.09, dy=0.1), Grid(nx=23, ny=28, dx=0.1, dy=0.09)
    options = {"coupling": coupling, "friction": 0.4, "tolerance": FINE}
    straight = Sphere(grid=grids[0], separation=ellipse(grids[0]), **options)
    turned = Sphere(grid=grids[1], separation=ellipse(grids[1], turned=True), **options)
    one, other = follow(straight), follow(turned, lambda qx, qy, m: (-qy, qx, m))

    def back(field):  # value at (x, y) is that of the turned one at (-y, x)
        return field[:, ::-1].T

    def vector(field):
        return np.stack([back(field[1]), -back(field[0])])

    same(back(other.normal.pressure), one.normal.pressure, straight.pressure)
    same(vector(other.tangential.shear), one.tangential.shear, straight.pressure)
    for name in ("position", "slip_distance", "dissipated", "lift"):
        found, expected = getattr(other.sliding, name), getattr(one.sliding, name)
        same(vector(found) if found.ndim == 3 else back(found), expected, 1.0)
    assert np.array_equal(back(other.tangential.stick), one.tangential.stick)
    dx, dy, phi = other.tangential.rigid
    same((dy, -dx, phi), one.tangential.rigid, 1.0)


def test_a_mirror_changes_signs_alone():
    """x -> -x: shear along x and the moment change sign."""
    grid = Grid(nx=26, ny=25, dx=0.1, dy=0.1)
    options = {"grid": grid, "coupling": "full", "friction": 0.4, "tolerance": FINE}
    straight = Sphere(separation=ellipse(grid), **options)
    mirrored = Sphere(separation=ellipse(grid)[:, ::-1].copy(), **options)
    one, other = follow(straight), follow(mirrored, lambda qx, qy, m: (-qx, qy, -m))
    same(other.tangential.shear[0, :, ::-1], -one.tangential.shear[0], straight.pressure)
    same(other.tangential.shear[1, :, ::-1], one.tangential.shear[1], straight.pressure)
    same(other.normal.pressure[:, ::-1], one.normal.pressure, straight.pressure)
    same(other.tangential.rigid * (-1, 1, -1), one.tangential.rigid, 1.0)


@pytest.fixture(scope="module")
def unit_course():
    """A fully coupled contact in units of one that has followed the course, and its last step."""
    grid = Grid(nx=26, ny=25, dx=0.1, dy=0.1)
    unit = Sphere(grid=grid, separation=ellipse(grid), coupling="full", friction=0.4)
    return unit, follow(unit)


@pytest.mark.parametrize(("length", "modulus"), [pytest.param(1.0, 2e11, marks=pytest.mark.slow), (3e-7, 7e10)])
def test_scale_of_length_and_of_modulus(unit_course, length, modulus):
    unit, one = unit_course
    grid = unit.grid
    small = Grid(nx=26, ny=25, dx=0.1 * length, dy=0.1 * length)
    body = Material(young_modulus=0.91 * modulus, poisson_ratio=0.3)
    scaled = Sphere(grid=small, separation=ellipse(grid) * length, coupling="full", friction=0.4, bodies=(body, None))
    scaled.load *= length**2
    other = follow(scaled, unit=length)
    same(other.tangential.shear / modulus, one.tangential.shear, 1e2 * unit.pressure)
    same(other.normal.pressure / modulus, one.normal.pressure, 1e2 * unit.pressure)
    same(other.tangential.rigid / (length, length, 1.0), one.tangential.rigid, 1e2)
    same(other.sliding.dissipated / (modulus * length), one.sliding.dissipated, 1e2)


@pytest.mark.parametrize(
    ("levels", "bodies"),
    [
        (("none", "partial"), (elastic(0.0), None)),  # the displacement across a shear is that of Poisson's ratio
        (("partial", "full"), (elastic(0.3), elastic(0.3))),  # like bodies: what couples to the pressure cancels
        (("partial", "full"), (elastic(0.5), None)),  # so it does where nothing is compressible
    ],
    ids=["nu = 0", "like bodies", "incompressible"],
)
def test_levels_of_coupling_that_must_agree(levels, bodies):
    grid = Grid(nx=26, ny=25, dx=0.1, dy=0.1)
    one, other = (
        follow(Sphere(grid=grid, separation=ellipse(grid), coupling=level, friction=0.4, bodies=bodies))
        for level in levels
    )
    # they take other ways to it: agreement to the tolerance of 1e-8
    same(other.tangential.shear, one.tangential.shear, 1e3)
    same(other.normal.pressure, one.normal.pressure, 1e3)


def test_levels_of_coupling_that_must_differ():
    grid = Grid(nx=26, ny=25, dx=0.1, dy=0.1)
    shears = [
        follow(Sphere(grid=grid, separation=ellipse(grid), coupling=level, friction=0.4)).tangential.shear
        for level in ("none", "partial", "one-way", "full")
    ]
    for one, other in pairwise(shears):
        assert np.abs(one - other).max() > 1e-3 * np.abs(one).max()


@pytest.mark.slow
def test_bodies_exchanged_reverse_the_shear():
    """The displacement across between pressure and shear changes sign, so that the shear under opposed loads does."""
    grid = Grid(nx=26, ny=25, dx=0.1, dy=0.1)
    one = Sphere(grid=grid, separation=ellipse(grid), coupling="full", friction=0.4, bodies=(elastic(0.3), None))
    other = Sphere(grid=grid, separation=ellipse(grid), coupling="full", friction=0.4, bodies=(None, elastic(0.3)))
    first, second = follow(one), follow(other, lambda qx, qy, m: (-qx, -qy, -m))
    same(second.tangential.shear, -first.tangential.shear, 1e2 * one.pressure)
    same(second.normal.pressure, first.normal.pressure, 1e2 * one.pressure)


def test_a_state_handed_on_is_all_that_is_needed():
    """Another contact object that begins from the state of the first goes on as that does."""
    s = Sphere(24, coupling="full")
    s.to(0.7, shift_x=0.1)
    fresh = Sphere(24, coupling="full")
    fresh.sliding = s.sliding
    one, other = s.to(1.0, shift_x=0.4, twist=0.1), fresh.to(1.0, shift_x=0.4, twist=0.1)
    np.testing.assert_array_equal(other.tangential.shear, one.tangential.shear)
