"""Shapes that offer only `contains`: volume fractions, and a field that converges to the exact one."""

import dataclasses

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.errors import SceneError
from eigencontact.halfspace.points import field_at_points
from eigencontact.halfspace.voxels import VoxelisedShape, volume_fractions, voxels_across
from eigencontact.library import installed_plugins
from eigencontact.model.installed import installed_cell
from eigencontact.plugin import InclusionShape


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


def test_far_away_the_cells_count_as_points():
    voxelised = _voxelised(Ball(), 8)
    distance = voxelised.far_field().distance
    points = (np.array([0.99, 1.01]) * distance, np.zeros(2), np.full(2, 1.5))
    near = field_at_points(voxelised, np.ones(6), points, poisson_ratio=0.3, quantity="stress")
    bare = voxelised._sum("psi", [(2, 2, 0)], *points)
    assert np.isfinite(near).all()
    from eigencontact.halfspace.point_kernels import source_derivatives

    sources = source_derivatives(voxelised.far_field(), "psi", [(2, 2, 0)], *points)
    assert sources[0, 1] == close(bare[0, 1], rel=1e-8)


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
        ({"eigenstrain": np.ones((3, 2))}, "eigenstrain must be of shape"),
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
