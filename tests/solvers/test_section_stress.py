"""Rows of target points: against the sum over loaded cells at points, and on the other side of every symmetry."""

import numpy as np
import pytest

from eigencontact.core.grid import Box, Grid
from eigencontact.solvers.section_stress import SectionStress
from eigencontact.solvers.subsurface import mirrored, stress_at_points
from solvers.test_subsurface import lattice_points, stress_kernels, tractions

# grid (ny, nx, dy, dx), loaded box, target, origin in cells, rows that mirror
CASES = {
    "midway, even": ((8, 10, 1.0, 0.7), Box(1, 7, 2, 9), (1, 10), (3.5, 0.0), 3),
    "midway, odd": ((8, 10, 1.0, 0.7), Box(1, 6, 2, 9), (1, 10), (3.0, 0.0), 2),
    "off the middle": ((8, 10, 1.0, 0.7), Box(1, 7, 2, 9), (1, 10), (4.0, 0.0), 0),
    "across": ((8, 10, 1.0, 0.7), Box(1, 7, 2, 9), (8, 1), (0.0, 5.0), 3),
    "across, between cells": ((8, 10, 1.0, 0.7), Box(1, 7, 2, 9), (8, 1), (-0.3, 4.7), 0),
    "beside the contact": ((6, 6, 1.0, 1.0), Box(2, 4, 2, 4), (1, 3), (2.5, 14.0), 1),
    "one point": ((6, 7, 1.0, 1.0), None, (1, 1), (2.5, 3.0), 3),
    "one cell": ((1, 1, 1.0, 2.0), None, (1, 1), (0.0, 0.0), 0),
    "one column of cells": ((7, 1, 1.0, 2.0), None, (1, 1), (0.5, 0.0), 0),
}


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_a_section_equals_the_sum_at_points(case, nu):
    """The sum is taken at points moved by less than its own error, so that it cannot use the mirror images."""
    (ny, nx, dy, dx), box, target, origin, images = case
    grid = Grid(ny=ny, nx=nx, dy=dy, dx=dx, center=(0.3, -1.0))
    depths = np.array([0.05, 0.5, 2.0, 7.0])
    loads, used = tractions(grid, 1, box), stress_kernels(nu)
    operator = SectionStress(
        grid, used, source=box or Box(0, ny, 0, nx), target=target, origin=origin, depths=depths, threads=2
    )
    assert operator._images == images
    found = operator.apply(loads)
    assert found.shape == (6, 4, *target)
    points = lattice_points(grid, target, origin, depths) + np.array([2e-12, 3e-12, 0.0])
    expected = stress_at_points(grid, used, loads, points).reshape(found.shape)
    assert np.abs(found - expected).max() < 2e-10 * np.abs(expected).max()


def test_points_on_the_axis_equal_points_beside_it():
    """On the axis of the loaded cells a quarter of them is evaluated, beside it every one."""
    grid = Grid(ny=8, nx=9, dy=1.0, dx=0.7)
    loads, used = tractions(grid, 3), stress_kernels()
    assert mirrored(0.0 - grid.x[::-1]) == 4
    assert mirrored(1e-11 - grid.x[::-1]) == 0
    on = np.array([[0.0, 0.0, z] for z in (0.3, 1.0, 4.0)])
    there, beside = (stress_at_points(grid, used, loads, on + d) for d in (0.0, np.array([1e-11, 1e-11, 0.0])))
    assert np.abs(there - beside).max() < 1e-9 * np.abs(beside).max()
    assert np.abs(there - beside).max() > 0


def test_single_precision_is_that():
    grid = Grid(ny=16, nx=16, dy=1.0, dx=1.0)
    loads, used, whole = tractions(grid, 2), stress_kernels(), Box(0, 16, 0, 16)
    single, double = (
        SectionStress(
            grid, used, source=whole, target=(1, 16), origin=(7.5, 0.0), depths=np.array([0.5, 3.0]), precision=kind
        ).apply(loads)
        for kind in ("single", "double")
    )
    assert 1e-9 < np.abs(single - double).max() / np.abs(double).max() < 1e-6
