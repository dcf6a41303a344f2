"""Means of stress over the cells next to the surface."""

import numpy as np

from eigencontact.core.grid import Box, Grid
from eigencontact.solvers.surface_means import CellMeans, MeansOnLattice, depth_of_means, means_at_points

GRID = Grid(nx=7, ny=6, dx=0.3, dy=0.2)
TRACTION = np.random.default_rng(8).random(GRID.shape)


class Smooth:
    """Kernel with a given polynomial or Gaussian in place of a stress."""

    components = ("xx", "yy", "zz", "yz", "xz", "xy")

    def __init__(self, value):
        self.value = value

    def parity(self, _component):
        return 1, 1

    def table(self, components, x, y, z, _half_widths):
        return np.array([(n + 1 + z) * self.value(x[None, :], y[:, None]) for n in range(len(components))])

    def response(self, components, kx, ky, _z):
        return np.ones((len(components), *np.broadcast_shapes(kx.shape, ky.shape)), dtype=complex)


def test_the_mean_of_a_quadratic_takes_four_points():
    """A third of a cell from the centre: (2/3)² of the squares of the half edges."""
    x, y, half = np.array([0.1, 0.4]), np.array([-0.2, 0.3]), (0.15, 0.1)

    def quadratic(x, y):
        return 1.0 + x + x * y + x**2 + 2.0 * y**2

    found = CellMeans(Smooth(quadratic)).table(["xx"], x, y, 0.0, half)[0]
    expected = quadratic(x[None], y[:, None]) + 4.0 / 9.0 * (half[0] ** 2 + 2.0 * half[1] ** 2)
    np.testing.assert_allclose(found, expected, rtol=1e-13)
    assert depth_of_means(GRID) == 0.25 * 0.2


def test_a_lattice_and_points_agree_between_the_centres():
    kernel = Smooth(lambda x, y: np.exp(-(x**2) - 2.0 * y**2))
    x, y, depths = np.array([-0.5, 0.0, 0.17]), np.array([-0.3, 0.1, 0.25, 0.41]), np.array([0.0, 0.04])
    lattice = MeansOnLattice(GRID, [kernel], source=Box(0, 6, 0, 7), x=x, y=y, depths=depths).apply([TRACTION])
    z, py, px = (values.ravel() for values in np.meshgrid(depths, y, x, indexing="ij"))
    found = means_at_points(GRID, [kernel], [TRACTION], np.column_stack([px, py, z]))
    np.testing.assert_allclose(found, lattice.reshape(6, -1), rtol=1e-12)
