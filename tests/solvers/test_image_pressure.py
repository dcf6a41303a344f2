"""The image-pressure scheme against the half-space theorem: as wrong as it is known to be, and no more."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.core.tensors import from_mandel, to_mandel
from eigencontact.errors import SceneError
from eigencontact.halfspace.points import field_at_points
from eigencontact.model.installed import installed_cell, installed_influence
from eigencontact.scene.installed import installed_plugins
from eigencontact.solvers.cells import Cells
from eigencontact.solvers.image_pressure import ImagePressure, ImagePressureVolume, reflected

MATERIAL = Material(young_modulus=1.0, poisson_ratio=0.3)
DIRECTIONS = {
    "dilatation": (1, 1, 1, 0, 0, 0),
    "zz": (0, 0, 1, 0, 0, 0),
    "xx": (1, 0, 0, 0, 0, 0),
    "xz": (0, 0, 0, 0, 1, 0),
    "traceless": (1, -0.5, -0.5, 0, 0, 0),
    "general": (0.3, -1.0, 0.7, 0.4, -0.6, 0.5),
}
WINDOW = {"target": (17, 17), "origin": (24.0, 24.0)}  # |x|, |y| <= 8 edges of 65 x 65 cells


class Case:
    """Unit cube at depth `z0` with an eigenstrain, on `n` x `n` cells of edge `cell`."""

    def __init__(self, direction, z0, *, n=65, cell=1.0, edges=(1.0, 1.0, 1.0)):
        self.shape = ec.make("cuboid", center=(0.0, 0.0, z0), edges=edges)
        self.strain = to_mandel(DIRECTIONS[direction])
        self.grid = Grid(nx=n, ny=n, dx=cell, dy=cell)
        kernel = installed_influence(installed_plugins(), "p")
        self.scheme = ImagePressure(grid=self.grid, kernel=kernel, material=MATERIAL)

    def field(self, quantity, points, space="full"):
        found = field_at_points(
            self.shape, self.strain, points, poisson_ratio=MATERIAL.poisson_ratio, quantity=quantity, space=space
        )
        return found * (MATERIAL.shear_modulus if quantity == "stress" else 1.0)

    def exact(self, quantity, points):
        return self.field(quantity, points, "half")

    def points(self, depth, target, origin):
        x = self.grid.x[0] + (origin[1] + np.arange(target[1])) * self.grid.dx
        y = self.grid.y[0] + (origin[0] + np.arange(target[0])) * self.grid.dy
        y, x = (axis.ravel() for axis in np.meshgrid(y, x, indexing="ij"))
        return x, y, np.full(x.size, float(depth))

    def pair(self, quantity, points):
        """Source and image in the infinite body."""
        x, y, z = points
        return self.field(quantity, points) + reflected(quantity, self.field(quantity, (x, y, -z)))

    @cached_property
    def pressure(self):
        """Twice the normal traction of the source at the middles of the cells."""
        return 2.0 * self.field("stress", self.points(0.0, self.grid.shape, (0.0, 0.0)))[2].reshape(self.grid.shape)

    def at_points(self, quantity, points):
        """Field by the scheme at scattered points."""
        out = self.pair(quantity, points)
        self.scheme.add_pressure_at(out, quantity, self.pressure, points)
        return out

    def on_lattice(self, quantity, *, target, origin, depths):
        """Field by the scheme on planes of points of the grid's pitch."""
        planes = [self.pair(quantity, self.points(depth, target, origin)).reshape(-1, *target) for depth in depths]
        out = np.stack(planes, axis=1)
        self.scheme.add_pressure(out, quantity, self.pressure, origin, depths)
        return out


# Largest error over the largest exact value in the window, in percent: u_z of the surface, and the largest stress
# component at a depth of 0.25, 0.5 and 1 edges. Found by a program that
# shares no code with this one, to the digits given.
KNOWN = [
    ("dilatation", 0.5, (0.4, 2, 0.9, 0.7)),
    ("dilatation", 1.5, (1.3, 7, 4, 0.3)),
    ("dilatation", 10.0, (3.3, 1.0, 0.5, 0.4)),
    ("zz", 0.5, (0.7, 45, 6, 1.1)),
    ("xx", 1.5, (7, 6, 3, 0.3)),
    ("xz", 0.5, (66, 59, 41, 34)),
    ("xz", 1.5, (6, 62, 37, 4)),
    ("traceless", 2.5, (2.0, 14, 12, 1.6)),
]


@pytest.mark.parametrize(
    ("direction", "z0", "percent"),
    [pytest.param(*row, id=f"{row[0]}-{row[1]:g}", marks=[pytest.mark.slow] * (row[1] != 0.5)) for row in KNOWN],
)
def test_error_of_the_scheme_is_the_known_one(direction, z0, percent):
    case = Case(direction, z0)
    surface = case.on_lattice("displacement", depths=np.zeros(1), **WINDOW)
    exact = case.exact("displacement", case.points(0.0, **WINDOW))[2]
    errors = [np.abs(surface[2].ravel() - exact).max() / np.abs(exact).max()]
    depths = np.array([0.25, 0.5, 1.0])
    stress = from_mandel(case.on_lattice("stress", depths=depths, **WINDOW))
    for k, depth in enumerate(depths):
        exact = from_mandel(case.exact("stress", case.points(depth, **WINDOW)))
        errors.append(np.abs(stress[:, k].reshape(6, -1) - exact).max() / np.abs(exact).max())
    for found, known in zip(errors, percent, strict=True):
        digit = 0.1 if known < 2 or known == 3.3 else 1.0
        assert abs(100.0 * found - known) <= 0.55 * digit


def test_cell_middles_are_free_of_traction():
    case = Case("general", 0.75, n=15)
    points = case.points(0.0, case.grid.shape, (0.0, 0.0))
    stress = case.at_points("stress", points)
    largest = np.abs(case.field("stress", points)).max()
    assert np.abs(stress[2:5]).max() <= 1e-13 * largest


@pytest.mark.parametrize("quantity", ["displacement", "strain", "stress"])
def test_points_and_planes_agree(quantity):
    case = Case("general", 0.5, n=9)
    lattice = {"target": (4, 5), "origin": (2.25, -1.0)}
    depths = np.array([0.0, 0.4, 2.0])
    planes = case.on_lattice(quantity, depths=depths, **lattice)
    for k, depth in enumerate(depths):
        at = case.at_points(quantity, case.points(depth, **lattice))
        assert np.abs(planes[:, k].reshape(len(at), -1) - at).max() <= 1e-13 * np.abs(at).max()


def test_strain_and_stress_obey_hookes_law_away_from_the_source():
    case = Case("general", 0.5, n=9)
    points = case.points(3.0, (9, 9), (0.0, 0.0))
    stress = case.at_points("stress", points)
    strain = case.at_points("strain", points)
    mu, nu = MATERIAL.shear_modulus, MATERIAL.poisson_ratio
    elastic = 2.0 * mu * strain
    elastic[:3] += 2.0 * mu * nu / (1.0 - 2.0 * nu) * strain[:3].sum(axis=0)
    assert np.abs(elastic - stress).max() <= 1e-13 * np.abs(stress).max()


@pytest.mark.slow
def test_finer_cells_of_the_same_window_come_closer():
    """Slowest for shear at the surface: its doubled traction has a logarithm at the edges of the cube."""
    for refinement, known in ((1, 0.66), (3, 0.27), (9, 0.12)):
        case = Case("xz", 0.5, n=17 * refinement, cell=1.0 / refinement)
        lattice = {"target": case.grid.shape, "origin": (0.0, 0.0)}
        found = case.on_lattice("displacement", depths=np.zeros(1), **lattice)[2].ravel()
        exact = case.exact("displacement", case.points(0.0, **lattice))[2]
        assert np.abs(found - exact).max() / np.abs(exact).max() == close(known, abs=0.01)


def test_flush_source_takes_the_surface_from_inside():
    case = Case("zz", 1.0, n=9, edges=(3.0, 3.0, 2.0))
    stress = case.at_points("stress", (np.zeros(1), np.zeros(1), np.zeros(1)))
    below = case.at_points("stress", (np.zeros(1), np.zeros(1), np.array([1e-7])))
    assert np.abs(stress - below).max() <= 1e-5 * np.abs(below).max()


@pytest.mark.parametrize("quantity", ["displacement", "strain", "stress"])
@pytest.mark.parametrize("flush", [True, False])
def test_cells_and_shapes_agree(quantity, flush):
    """A block of 3 x 3 x 2 cells is a cuboid."""
    depth = 0.0 if flush else 1.5
    case = Case("general", depth + 1.0, n=9, edges=(3.0, 3.0, 2.0))
    x, y = float(case.grid.x[3]), float(case.grid.y[3])
    source = Cells(first=(x, y, depth + 0.5), pitch=(1.0, 1.0, 1.0), shape=(2, 3, 3))
    target = Cells(first=(float(case.grid.x[0]), y - 0.25, 0.5), pitch=(1.0, 1.0, 1.0), shape=(5, 4, 9))
    cell = installed_cell(installed_plugins())((0.0, 0.0, 2.0), (1.0, 1.0, 1.0))
    operator = ImagePressureVolume(case.scheme, cell, source, target, quantity=quantity)
    strain = np.broadcast_to(case.strain[:, None, None, None], (6, 2, 3, 3))
    lattice = {"target": (4, 9), "origin": (2.75, 0.0), "depths": target.centres(2)}
    wanted = case.on_lattice(quantity, **lattice)
    assert np.abs(operator.apply(strain) - wanted).max() <= 1e-12 * np.abs(wanted).max()


def test_unknown_quantity_is_refused():
    case = Case("zz", 1.0, n=1)
    with pytest.raises(SceneError, match=r"image-pressure\.quantity must be one of 'displacement'"):
        case.scheme.add_pressure_at(np.zeros((6, 1)), "heat", np.ones((1, 1)), case.points(0.0, (1, 1), (0.0, 0.0)))
