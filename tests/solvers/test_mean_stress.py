"""Means over cells: against closed forms at Gauss points, and the energy that makes them worth having."""

import numpy as np
import pytest

from eigencontact.halfspace.points import field_at_points
from eigencontact.solvers.cells import Cells
from eigencontact.solvers.eigenstrain import VolumeField
from eigencontact.solvers.mean_stress import MeanVolumeField
from eigencontact_plugins.shapes.cuboid import Cuboid

CELL = Cuboid(center=(0.0, 0.0, 1.0), edges=(1.0, 1.0, 1.0))


def box(pitch, shape, layer=0):
    return Cells(first=(0.0, 0.0, (layer + 0.5) * pitch[2]), pitch=pitch, shape=shape)


def dense(kind, cells, space):
    """Minus the operator as a matrix: energy released by eigenstrain."""
    unit = np.eye(6 * cells.points)
    operator = kind(CELL, cells, cells, poisson_ratio=0.3, space=space)
    return np.array([-operator.apply(column.reshape(6, *cells.shape)).ravel() for column in unit]).T


def direct_means(pitch, strain, count):
    """Means over 3 x 3 x 3 cells of what the middle one causes, by `count` Gauss points per axis, and the cells."""
    cells = box(pitch, (3, 3, 3))
    source = Cuboid(center=tuple(cells.centres(axis)[1] for axis in range(3)), edges=pitch)
    points, weights = np.polynomial.legendre.leggauss(count)
    axes = [(cells.centres(axis)[:, None] + 0.5 * pitch[axis] * points).ravel() for axis in range(3)]
    z, y, x = (values.ravel() for values in np.meshgrid(axes[2], axes[1], axes[0], indexing="ij"))
    values = field_at_points(source, strain, (x, y, z), poisson_ratio=0.3, quantity="stress", space="full")
    values = values.reshape(6, 3, count, 3, count, 3, count)
    return np.einsum("czaybxd,a,b,d->czyx", values, *[weights / 2] * 3), cells


def middle(strain):
    out = np.zeros((6, 3, 3, 3))
    out[:, 1, 1, 1] = strain
    return out


def test_means_are_those_over_gauss_points():
    strain = np.random.default_rng(0).standard_normal(6)
    expected, cells = direct_means((1.0, 1.0, 1.0), strain, 2)
    found = MeanVolumeField(CELL, cells, cells, poisson_ratio=0.3, space="full").apply(middle(strain))
    assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("pitch", [(1.0, 1.0, 1.0), (1.0, 1.0, 0.3), (0.4, 1.0, 0.5)], ids=str)
def test_means_are_much_nearer_to_the_truth_than_values_in_centres(pitch):
    strain = np.random.default_rng(0).standard_normal(6)
    expected, cells = direct_means(pitch, strain, 8)
    errors = [
        np.abs(kind(CELL, cells, cells, poisson_ratio=0.3, space="full").apply(middle(strain)) - expected).max()
        for kind in (MeanVolumeField, VolumeField)
    ]
    assert errors[0] < 0.3 * errors[1]
    assert errors[0] < 0.05 * np.abs(expected).max()


@pytest.mark.parametrize("space", ["full", "half"])
@pytest.mark.parametrize("pitch", [(1.0, 1.0, 1.0), (1.0, 1.0, 0.2), (0.3, 1.0, 1.0)], ids=str)
def test_no_eigenstrain_gains_energy(pitch, space):
    matrix = dense(MeanVolumeField, box(pitch, (3, 3, 3)), space)
    if space == "full":
        assert np.abs(matrix - matrix.T).max() < 1e-14 * np.abs(matrix).max()
    assert np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min() > 0


def test_values_in_centres_do():
    """What the means are for; were it to fail, `VolumeField` would serve."""
    matrix = dense(VolumeField, box((1.0, 1.0, 1.0), (3, 3, 3)), "full")
    values = np.linalg.eigvalsh(matrix)
    assert values[0] < -0.03 * values[-1]
