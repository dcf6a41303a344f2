"""Cylinder as an inclusion: the region, its bounds, refusals."""

import numpy as np
import pytest

import eigencontact
from close import close
from eigencontact.plugin import SceneError
from eigencontact_plugins.shapes.cylinder import Cylinder

CENTER = (0.3, -0.2, 4.0)
AXES = ["x", "y", "z", (0.0, 0.0, -3.0), (1.0, -2.0, 0.5), (1e-200, 0.0, 2e-200)]


def inside_share(shape, n=80):
    """Share of the box of bounds that lies inside, and the layers of sample points that hold any."""
    low, high = (np.array(corner) for corner in shape.bounds)
    x, y, z = (low[:, None] + (high - low)[:, None] * (np.arange(n) + 0.5) / n).reshape(3, n)
    inside = shape.contains(x[:, None, None], y[:, None], z)
    assert inside.shape == (n, n, n)
    ends = [inside.any(axis=tuple({0, 1, 2} - {axis}))[[1, -2]].all() for axis in range(3)]
    return inside.mean() * np.prod(high - low), all(ends)


@pytest.mark.parametrize("axis", AXES)
def test_contains_fills_the_volume_within_tight_bounds(axis):
    shape = Cylinder(center=CENTER, radius=0.8, length=3.0, axis=axis)
    assert shape.volume == close(np.pi * 0.64 * 3)
    volume, tight = inside_share(shape)
    assert volume == close(shape.volume, rel=4e-3)
    assert tight


def test_a_named_axis_is_its_direction():
    points = np.random.default_rng(0).uniform(-2, 2, (3, 500)) + np.array(CENTER)[:, None]
    for name, direction in {"x": (2, 0, 0), "y": (0, -1, 0), "z": (0, 0, 1)}.items():
        one = Cylinder(center=CENTER, radius=0.8, length=3.0, axis=name)
        other = Cylinder(center=CENTER, radius=0.8, length=3.0, axis=direction)
        assert np.array_equal(one.contains(*points), other.contains(*points))
        assert 0 < one.contains(*points).sum() < 500


@pytest.mark.parametrize(
    ("point", "inside"),
    [((0.8, 0, 0), True), ((0.8000001, 0, 0), False), ((0, 0, 1.5), True), ((0, 0, -1.5000001), False),
     ((0.56, -0.57, 1.4), True), ((0.57, -0.57, 1.4), False)],
)  # fmt: skip
def test_boundary_belongs_to_it(point, inside):
    shape = Cylinder(center=(0, 0, 0), radius=0.8, length=3.0)
    assert bool(shape.contains(*np.array(point))) is inside


def test_voxels_of_a_deep_cylinder_converge_to_its_dilatation_field():
    """Far away only the volume counts: u = (1 + nu)/(1 - nu) e V r/(4 π r³) of a dilatation in full space."""
    shape = eigencontact.make("cylinder", kind="inclusion-shape", center=(0, 0, 50e-6), radius="1 um", length="2 um")
    at = np.array([[30e-6, 0, 50e-6]])
    u = eigencontact.inclusion_field(
        shape, 1e-3 * np.eye(3), at, young_modulus=210e9, poisson_ratio=0.3, quantity="displacement", space="full"
    )
    expected = 1.3 / 0.7 * 1e-3 * shape.volume / (4 * np.pi * 30e-6**2)
    assert u[0, 0] == close(expected, rel=5e-3)


REFUSED = [
    ({"center": (0, 0)}, r"cylinder.center must be three finite lengths"),
    ({"radius": 0.0}, r"cylinder.radius must be positive and finite \[m\] \(got 0.0\)"),
    ({"radius": np.nan}, r"cylinder.radius must be positive"),
    ({"length": -1.0}, r"cylinder.length must be positive and finite \[m\] \(got -1.0\)"),
    ({"axis": "w"}, r"cylinder.axis must be 'x', 'y', 'z' or a direction of three numbers, not all zero \(got 'w'\)"),
    ({"axis": (0.0, 0.0, 0.0)}, r"cylinder.axis must be"),
    ({"axis": (1.0, np.inf, 0.0)}, r"cylinder.axis must be"),
    ({"axis": (1.0, 2.0)}, r"cylinder.axis must be"),
]


@pytest.mark.parametrize(("change", "message"), REFUSED)
def test_refusals(change, message):
    with pytest.raises(SceneError, match=message):
        Cylinder(**({"center": CENTER, "radius": 0.8, "length": 3.0} | change))
