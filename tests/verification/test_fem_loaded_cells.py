"""Meshes that follow small cells, against cuboids of uniform eigenstrain by quadrature, which know no mesh."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from eigencontact_verification.fem.followed_cells import has_small_cells
from eigencontact_verification.fem.loaded_body import Cells, LoadedBody
from eigencontact_verification.fem.loaded_mesh import family_grid, reach_of
from eigencontact_verification.fem.loaded_solid import solve_loaded
from eigencontact_verification.fem.uncertainty import estimate
from eigencontact_verification.oracles import cuboid_quadrature, mindlin

FloatArray = NDArray[np.float64]

NU, YOUNG = 0.3, 2.6  # shear modulus 1
STRAIN = np.diag([-1e-3, -1e-3, 2e-3])
#: Cells from the axis and from the first depth to the last that boxes of one more STRAIN reach.
NESTED = ((4, 1, 8), (3, 2, 7), (2, 3, 6))
CELLS = 10


def stair() -> LoadedBody:
    """Half-space with an eigenstrain that rises by steps to the middle of its cells, of the edge 1."""
    edges = np.arange(CELLS + 1.0)
    middle = (edges[1:] + edges[:-1]) / 2
    z, y, x = np.meshgrid(middle, middle - CELLS / 2, middle - CELLS / 2, indexing="ij")
    steps = sum(((np.abs(x) < w) & (np.abs(y) < w) & (z > a) & (z < b)).astype(float) for w, a, b in NESTED)
    cells = Cells(x=edges - CELLS / 2, y=edges - CELLS / 2, z=edges, eigenstrain=STRAIN[:, :, None, None, None] * steps)
    return LoadedBody(young_modulus=YOUNG, poisson_ratio=NU, cells=(cells,))


def exact(points: FloatArray) -> FloatArray:
    """Stress (n, 3, 3) of the nested boxes."""
    found = np.zeros((len(points), 3, 3))
    for half, top, bottom in NESTED:
        place = (0.0, 0.0, (top + bottom) / 2), (2.0 * half, 2.0 * half, float(bottom - top))
        gradients = cuboid_quadrature.gradient_moments(points, *place)
        share = cuboid_quadrature.inside(points, *place)
        found += mindlin.stress(gradients, STRAIN, NU, share)
    return found


def grids(budget: int, near: FloatArray | None = None) -> list[Any]:
    """The three meshes of a quarter."""
    body = stair()
    reach = reach_of(body, 16.0)
    settings: dict[str, Any] = {"budget": budget, "ratio": 2.0, "near": near}
    return [family_grid(body, ("even", "even"), reach, level=level, **settings)[0] for level in (0, 1, 2)]


@pytest.mark.parametrize("budget", [250_000, 600_000])
def test_faces_of_cells_are_lines_of_the_fine_mesh_and_levels_are_nested(budget: int) -> None:
    assert has_small_cells(stair())
    meshes = grids(budget)
    assert 3 * np.prod([2 * n + 1 for n in meshes[2].shape]) <= budget
    for axis, last in ((0, 4.0), (1, 4.0), (2, 8.0)):
        fine = meshes[2].lines[axis]
        for face in np.arange(float(axis == 2), last + 1):
            assert np.abs(fine - face).min() < 1e-9
        for coarser, finer in pairwise(mesh.lines[axis] for mesh in meshes):
            assert finer.size == 2 * coarser.size - 1
            inside = (coarser > 1.0 - 1e-9) & (coarser < last + 1e-9)
            assert np.abs(coarser[inside, None] - finer).min(axis=1).max() < 1e-9


def test_far_from_what_is_read_fewer_elements_follow_the_cells() -> None:
    axis = np.array([(0.5, 0.5, z + 0.5) for z in range(9)])
    for points, expected in ((None, [8, 8]), (axis, [8, 4])):
        line = grids(3_000_000, points)[2].lines[0]
        assert [int(np.sum((line >= low) & (line < low + 2.0))) for low in (0.0, 2.0)] == expected


@pytest.mark.slow
def test_uncertainty_contains_the_stress_in_the_middle_of_cells_that_step() -> None:
    body = stair()
    below = np.array([(0.5, 0.5, z + 0.5) for z in range(10)])
    across = np.array([(x + 0.5, 0.5, 4.5) for x in range(6)])
    points = np.concatenate([below, across])
    found = {
        (level, outer): solve_loaded(
            body, level=level, outer=outer, watched=points, read=points, budget=600_000, reaches=16.0, ratio=2.0
        ).stress(points)
        for level, outer in ((0, "fixed"), (1, "fixed"), (2, "fixed"), (1, "free"))
    }
    truth = exact(points)
    for part in (slice(0, len(below)), slice(len(below), None)):
        reference = estimate(
            *(found[level, "fixed"][part].reshape(-1, 9) for level in (0, 1, 2)), ratio=2.0, formal_order=2.0,
            other_outer=found[1, "free"][part].reshape(-1, 9), other_level=1,
        )  # fmt: skip
        off = np.abs(reference.value - truth[part].reshape(-1, 9))
        assert np.all(off <= reference.uncertainty + 1e-7 * np.abs(truth).max())
        assert off.max() < 0.01 * np.abs(truth).max()
        assert reference.uncertainty.max() < 0.05 * np.abs(truth).max()
