"""Contact area: the correction for cells cut by the edge of the contact."""

import numpy as np
import pytest

from close import close
from eigencontact.core.grid import Grid
from eigencontact.solvers.contact_area import contact_area


def disc(cells, shift, stretch=1.0):
    """Cells touched by more than a corner of a disc of unit radius: every cell that the edge cuts counts whole."""
    dx, dy = 1.0 / cells, stretch / cells
    n = 2 * int(1.3 * cells)
    grid = Grid(nx=n, ny=n, dx=dx, dy=dy)
    x = np.maximum(np.abs(grid.x - shift[0] * dx) - 0.5 * dx, 0.0)[None, :]
    y = np.maximum(np.abs(grid.y - shift[1] * dy) - 0.5 * dy, 0.0)[:, None]
    return x**2 + (y / stretch) ** 2 < 1.0, grid


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.3, 0.1), (0.5, 0.25)])
def test_taking_off_the_cut_cells_brings_a_disc_nearer_than_the_count(shift):
    loaded, grid = disc(40, shift)
    count = np.count_nonzero(loaded) * grid.cell_area
    assert count > np.pi
    assert abs(contact_area(loaded, grid) - np.pi) < 0.8 * (count - np.pi)


def test_stretched_cells_give_the_stretched_area():
    loaded, grid = disc(30, (0.2, 0.4))
    stretched, tall = disc(30, (0.2, 0.4), stretch=7.0)
    assert np.array_equal(loaded, stretched)
    assert contact_area(stretched, tall) == close(7.0 * contact_area(loaded, grid), rel=1e-12)


def test_full_contact_has_no_edge_and_a_period_has_one_where_the_window_wraps():
    grid = Grid(nx=6, ny=4, dx=0.5, dy=0.25)
    full = np.ones(grid.shape, dtype=bool)
    assert contact_area(full, grid) == close(24 * 0.125)
    half = full.copy()
    half[:, 3:] = False
    per = (np.pi - 1 + np.log(2)) / 24
    assert contact_area(half, grid) == close((12 - 4 * per) * 0.125)
    assert contact_area(half, grid, periodic=True) == close((12 - 8 * per) * 0.125)


def test_nothing_loaded_is_no_area():
    grid = Grid(nx=3, ny=3, dx=1.0, dy=1.0)
    assert contact_area(np.zeros(grid.shape, dtype=bool), grid) == 0.0
