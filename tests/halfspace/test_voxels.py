"""Shapes that offer only `contains`: volume fractions, and a field that converges to the exact one."""

import dataclasses
import time

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.errors import SceneError
from eigencontact.halfspace.point_kernels import source_derivatives
from eigencontact.halfspace.points import field_at_points
from eigencontact.halfspace.potentials import derivatives
from eigencontact.halfspace.voxelised import VoxelisedShape
from eigencontact.halfspace.voxels import volume_fractions, voxels_across
from eigencontact.model.installed import installed_cell
from eigencontact.plugin import InclusionShape
from eigencontact.scene.installed import installed_plugins


class Ball:
    """A sphere that hides its potentials."""

    key = "ball"
    bounds = ((-1.0, -1.0, 0.5), (1.0, 1.0, 2.5))

    def contains(self, x, y, z):
        return x**2 + y**2 + (z - 1.5) ** 2 <= 1.0


def _voxelised(region, cells):
    return VoxelisedShape(region, installed_cell(installed_plugins()), cells)


def test_fractions_sum_to_the_volume():
    errors = []
    for cells in (8, 16, 32):
        voxels = voxels_across(Ball.bounds, cells)
        volume = volume_fractions(Ball(), voxels).sum() * np.prod(voxels.edges)
        errors.append(abs(volume / (4 * np.pi / 3) - 1))
    assert max(errors) < 2e-3
    assert errors[2] < 2e-4


def test_an_aligned_cuboid_is_voxelised_exactly():
    cuboid = ec.make("cuboid", center=(0.0, 0.0, 0.5), edges=(2.0, 1.0, 1.0))
    voxelised = _voxelised(cuboid, 8)
    assert voxelised.volume == close(2.0, rel=1e-14)
    points = (np.array([0.3, 1.5, 0.1]), np.array([0.1, 0.2, 2.0]), np.array([0.0, 0.4, 1.3]))
    for quantity in ("displacement", "stress"):
        cut, exact = (
            field_at_points(shape, np.arange(1.0, 7.0), points, poisson_ratio=0.3, quantity=quantity)
            for shape in (voxelised, cuboid)
        )
        assert np.abs(cut - exact).max() < 1e-12 * np.abs(exact).max()


def test_the_field_converges_to_that_of_the_sphere():
    sphere = ec.make("sphere", center=(0.0, 0.0, 1.5), radius=1.0)
    line = np.linspace(-2.0, 2.0, 9)
    points = (line, 0.3 * line, np.zeros(9))
    exact = field_at_points(sphere, np.ones(6), points, poisson_ratio=0.3, quantity="displacement")
    errors = []
    for cells in (4, 8, 16):
        cut = field_at_points(_voxelised(Ball(), cells), np.ones(6), points, poisson_ratio=0.3, quantity="displacement")
        errors.append(np.abs(cut - exact).max() / np.abs(exact).max())
    order = np.polyfit(np.log([4, 8, 16]), np.log(errors), 1)[0]
    assert order == close(-2.0, abs=0.4)
    assert errors[2] < 2.5e-3


class Lattice:
    """Cells of given fractions, 1 x 1 x 0.9 each."""

    key = "lattice"

    def __init__(self, fractions, low=(-2.0, -1.0, 0.0)):
        self.fractions, self.low, self.edges = np.asarray(fractions), np.array(low), np.array([1.0, 1.0, 0.9])

    @property
    def bounds(self):
        nz, ny, nx = self.fractions.shape
        return tuple(self.low.tolist()), tuple((self.low + self.edges * (nx, ny, nz)).tolist())

    def contains(self, *_):
        raise AssertionError("the fractions are known")

    def volume_fractions(self, low, edges, shape):
        assert (*low, *edges, *shape) == close((*self.low, *self.edges, *self.fractions.shape), abs=1e-12)
        return self.fractions

    def cells(self):
        for (k, j, i), fraction in np.ndenumerate(self.fractions):
            center = self.low + (np.array([i, j, k]) + 0.5) * self.edges
            yield fraction, ec.make("cuboid", center=tuple(center.tolist()), edges=tuple(self.edges.tolist()))


ORDERS = {
    "phi": [(i, j, n - i - j) for n in (1, 2, 3, 4) for i in range(n + 1) for j in range(n - i + 1)],
    "psi": [(i, j, n - i - j) for n in (3, 4, 5) for i in range(n + 1) for j in range(n - i + 1)],
    "chi": [(i, n - i - k, k) for n in (3, 4) for k in (0, 1) for i in range(n - k + 1)],
}
# In cells from the lowest corner: beside the lattice and in it, on faces of cells, on lines of their edges, and in the
# surface, seen from both sides.
PLACES = np.array(
    [
        (2.3, 1.1, 0.7), (0.3, 2.9, 1.6), (11.0, -6.0, 10.0), (1.0, 1.3, 1.2), (2.2, 2.0, 0.2), (2.4, 1.1, 1.0),
        (2.3, 2.0, 7.0), (-4.0, 2.0, 1.0), (2.0, 8.0, 1.0), (2.0, 2.0, 8.0), (2.0 + 1e-5, 2.0, 7.0),
        (2.3, 1.1, 0.0), (1.7, 1.6, -0.0), (-3.0, 1.2, 0.0), (-3.0, 1.2, -0.0), (4.0, 1.3, 0.4),
        (2.0 - 1e-14, 1.2, 0.4),
    ]
).T  # fmt: skip


@pytest.mark.parametrize("name", ["phi", "psi", "chi"])
@pytest.mark.parametrize("low", [(-2.0, -1.0, 0.0), (-2.0, -1.0, 2.0)], ids=["flush", "deep"])
def test_corners_of_cells_add_up_to_the_cells(name, low):
    """Also on the lines of edges that no fraction differs across, where single corners are singular."""
    fractions = np.random.default_rng(4).uniform(0.1, 0.9, (4, 3, 4))
    fractions[:2, 1:] = 1.0
    fractions[0, 0, 0] = 0.0
    lattice = Lattice(fractions, low)
    voxelised = _voxelised(lattice, 4)
    x, y, z = PLACES * lattice.edges[:, None]
    x, y = x + low[0], y + low[1]
    z = np.abs(z) if name == "chi" else z + (low[2] or -0.0)
    at = (ORDERS[name], x, y, z)
    singly = sum(f * (cell.chi(*at) if name == "chi" else derivatives(cell, name, *at)) for f, cell in lattice.cells())
    together = getattr(voxelised, name)(*at)
    assert (np.abs(together - singly) / np.abs(singly).max(axis=0)).max() < 2e-12


def test_points_stand_for_the_cells_of_a_flat_region_far_away():
    """Its cells are not cubes; where points take over both agree."""
    fractions = np.random.default_rng(5).uniform(0.0, 1.0, (3, 8, 8))
    voxelised = _voxelised(Lattice(fractions, (-4.0, -4.0, 1.0)), 8)
    far = voxelised.far_field()
    assert far.volumes.sum() == close(voxelised.volume, rel=1e-13, abs=0.0)
    assert np.ptp(far.positions, axis=0) == close([8.0, 8.0, 2.7], rel=0.1, abs=0.0)
    at = far.center[:, None] + 1.01 * far.distance * np.array([(1, 0, 0), (0.6, 0.64, 0.48), (0, 0, 1.0)]).T
    for name, orders in ORDERS.items():
        nodes = getattr(voxelised, name)(orders, *at)
        points = source_derivatives(far, name, orders, *at)
        for total in {sum(order) for order in orders}:
            rows = [row for row, order in enumerate(orders) if sum(order) == total]
            assert np.abs(points - nodes)[rows].max() < 3e-9 * np.abs(nodes[rows]).max()


@pytest.mark.parametrize("quantity", ["displacement", "strain", "stress"])
@pytest.mark.parametrize("space", ["half", "full"])
def test_a_few_points_of_many_cells_take_no_time(quantity, space):
    """Twelve thousand cells, four thousand of them cut: half a minute when each was a cuboid of its own."""
    ball, n = Ball(), 29
    started = time.perf_counter()
    voxelised = _voxelised(ball, n)
    points = np.random.default_rng(8).uniform(-2.0, 2.0, (3, 8))
    points[2] = np.abs(points[2])
    field = field_at_points(voxelised, np.ones(6), tuple(points), poisson_ratio=0.3, quantity=quantity, space=space)
    assert time.perf_counter() - started < 2.0
    ball_itself = ec.make("sphere", center=(0.0, 0.0, 1.5), radius=1.0)
    exact = field_at_points(ball_itself, np.ones(6), tuple(points), poisson_ratio=0.3, quantity=quantity, space=space)
    assert np.abs(field - exact).max() < 2e-2 * np.abs(exact).max()


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (np.ones((2, 2)), r"lattice.volume_fractions must be of shape \(4, 3, 4\), in 0 to 1 \(got 'shape \(2, 2\)'"),
        (np.full((4, 3, 4), 1.5), r"lattice.volume_fractions must be of shape .* \(got \[1.5\]\)"),
        (np.full((4, 3, 4), np.nan), r"lattice.volume_fractions must be of shape .* \(got \[nan\]\)"),
    ],
)
def test_wrong_fractions_of_a_shape_are_refused(answer, message):
    lattice = Lattice(np.ones((4, 3, 4)))
    lattice.volume_fractions = lambda *_: answer
    with pytest.raises(SceneError, match=message):
        _voxelised(lattice, 4)


def test_a_contains_of_the_wrong_shape_is_refused():
    @dataclasses.dataclass(frozen=True, kw_only=True)
    class Wrong(InclusionShape):
        key = "wrong"
        bounds = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))

        def contains(self, x, y, z):  # noqa: ARG002
            return x > 0.5

    with pytest.raises(SceneError, match=r"wrong.contains must return booleans of the broadcast shape"):
        ec.inclusion_field(Wrong(), np.eye(3), [[0, 0, 2.0]], young_modulus=1.0, poisson_ratio=0.3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"eigenstrain": np.ones((3, 2))}, "eigenstrain must be one number, or of shape"),
        ({"eigenstrain": [[0, 1, 0], [0, 0, 0], [0, 0, 0]]}, "eigenstrain must be symmetric"),
        ({"points": [[0, 0, -1.0]]}, "points must be at z of 0 or more"),
        ({"points": [[0, 0, np.nan]]}, "points must be finite"),
        ({"poisson_ratio": 0.6}, "poisson_ratio must be in"),
        ({"quantity": "stres"}, "quantity must be one of"),
        ({"space": "quarter"}, "space must be 'half' or 'full'"),
        ({"shape": "cuboid"}, "shape must be an inclusion shape"),
        ({"shape": ec.make("sphere", center=(0, 0, 0.5), radius=1.0)}, "sphere must lie below the surface"),
    ],
)
def test_bad_arguments_of_inclusion_field_are_named(change, message):
    given = {
        "shape": ec.make("cuboid", center=(0, 0, 1.0), edges=(1, 1, 1)),
        "eigenstrain": np.eye(3),
        "points": [[0, 0, 0]],
        "young_modulus": 1.0,
        "poisson_ratio": 0.3,
    } | change
    shape, eigenstrain, points = (given.pop(name) for name in ("shape", "eigenstrain", "points"))
    with pytest.raises(SceneError, match=message):
        ec.inclusion_field(shape, eigenstrain, points, **given)
