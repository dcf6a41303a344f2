"""Meshes of loaded bodies follow regions that end in planes, with long elements along bars."""

from __future__ import annotations

import numpy as np
import pytest

from eigencontact_verification.fem.loaded_body import LoadedBody
from eigencontact_verification.fem.loaded_mesh import family_grid, has_flat_ends
from eigencontact_verification.fem.model import Region

BOUNDS = ((-8.0, -1.0, 2.0), (8.0, 1.0, 4.0))


def region(contains):
    return Region(contains=contains, bounds=BOUNDS, eigenstrain=np.eye(3))


def bar(x, y, z):
    return (np.abs(x) <= 8.0) & (y**2 + (z - 3.0) ** 2 <= 1.0)


def spindle(x, y, z):
    return (x / 8.0) ** 2 + y**2 + (z - 3.0) ** 2 <= 1.0


def box(x, y, z):
    return (np.abs(x) <= 8.0) & (np.abs(y) <= 1.0) & (np.abs(z - 3.0) <= 1.0)


@pytest.mark.parametrize(
    ("contains", "flat"), [(bar, [True, False, False]), (spindle, [False] * 3), (box, [True] * 3)]
)  # fmt: skip
def test_flat_ends_are_those_of_bars_and_boxes(contains, flat):
    assert [has_flat_ends(region(contains), axis) for axis in range(3)] == flat


def test_a_mesh_has_lines_at_the_ends_of_a_bar_and_more_elements_across_it():
    grids = {}
    for contains in (bar, spindle):
        body = LoadedBody(young_modulus=1.0, poisson_ratio=0.3, regions=(region(contains),))
        grids[contains], _ = family_grid(body, ("even", "even"), 64.0, level=2, budget=100_000)
    assert np.abs(grids[bar].lines[0] - 8.0).min() < 1e-12
    across = {contains: np.count_nonzero(grid.lines[1] <= 1.0) for contains, grid in grids.items()}
    assert across[bar] > 1.4 * across[spindle]
