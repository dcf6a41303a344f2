"""Mean displacement of the surface by Betti's theorem, against displacements at points averaged over the cells."""

import numpy as np
import pytest

from close import close
from eigencontact.core.grid import Box, Grid
from eigencontact.core.material import Material
from eigencontact.model.installed import installed_cell, installed_influence
from eigencontact.model.kernels import StressCoefficients
from eigencontact.scene.installed import installed_plugins
from eigencontact.solvers.cells import Cells
from eigencontact.solvers.eigenstrain_planes import PlaneFields
from eigencontact.solvers.mean_surface import MeanStressKernel, SurfaceAndCells
from eigencontact.solvers.subsurface import SubsurfaceStress

BODY = Material(young_modulus=2.0, poisson_ratio=0.3)
GRID = Grid(nx=8, ny=7, dx=1.0, dy=1.2)
SOURCE = Cells(first=(float(GRID.x[2]), float(GRID.y[1]), 0.4), pitch=(1.0, 1.2, 0.8), shape=(3, 4, 5))


def kernels():
    registry = installed_plugins()
    return [
        MeanStressKernel(StressCoefficients(installed_influence(registry, name), BODY), 0.8)
        for name in ("q_x", "q_y", "p")
    ]


# Layer that carries the eigenstrain -> error of the means by few Gauss points, for a strain that alternates at random.
@pytest.mark.parametrize(("layer", "bound"), [(0, 2e-2), (1, 1e-2), (2, 3e-3)])
def test_means_are_those_of_the_field_at_points(layer, bound):
    strain = np.zeros((6, *SOURCE.shape))
    strain[:, layer] = np.random.default_rng(0).normal(size=(6, *SOURCE.shape[1:]))
    found = SurfaceAndCells(GRID, kernels(), "xyz", SOURCE).displacement(strain)
    cell = installed_cell(installed_plugins())((0.0, 0.0, 0.5), (1.0, 1.0, 1.0))
    points, weights = np.polynomial.legendre.leggauss(4)
    expected = np.zeros_like(found)
    for y, of_y in zip(0.5 * points, 0.5 * weights, strict=True):
        for x, of_x in zip(0.5 * points, 0.5 * weights, strict=True):
            field = PlaneFields(
                cell, SOURCE, target=GRID.shape, origin=(y - 1.0, x - 2.0), depths=[0.0], poisson_ratio=0.3,
                quantity="displacement",
            )  # fmt: skip
            expected += of_y * of_x * field.apply(strain)[:, 0]
    for mine, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(mine, other, rtol=0, atol=bound * np.abs(other).max())


# Boxes on columns of the grid, and far beside it, where the parity is given up: first column and row of the box.
@pytest.mark.parametrize("place", [(2, 1), (-1, 5), (40, 1), (2, -30), (-25, 33)])
def test_load_and_displacement_are_adjoint(place):
    """Work of any tractions on the displacement is that of their stress on the eigenstrain, to round-off."""
    rng = np.random.default_rng(1)
    first = (float(GRID.x[0]) + place[0] * GRID.dx, float(GRID.y[0]) + place[1] * GRID.dy, 0.4)
    box = Cells(first=first, pitch=SOURCE.pitch, shape=SOURCE.shape)
    both = SurfaceAndCells(GRID, kernels(), "xyz", box)
    tractions, strain = rng.normal(size=(3, *GRID.shape)), rng.normal(size=(6, *box.shape))
    stress = SubsurfaceStress(
        GRID, kernels(), source=Box(0, GRID.ny, 0, GRID.nx), target=box.shape[1:], origin=(place[1], place[0]),
        depths=box.centres(2),
    ).apply(list(tractions))  # fmt: skip
    np.testing.assert_allclose(both.stress(list(tractions)), stress, rtol=0, atol=1e-13 * np.abs(stress).max())
    outside = np.sum(tractions * both.displacement(strain)) * GRID.cell_area
    inside = np.sum(stress * strain) * np.prod(box.pitch)
    assert outside == close(inside, rel=1e-11, abs=0)
