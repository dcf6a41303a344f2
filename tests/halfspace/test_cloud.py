"""Clouds of inclusions: the compiled sums against the shapes' own potentials, one by one."""

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.halfspace.cloud import field_of_cloud
from eigencontact.halfspace.points import field_at_points

RNG = np.random.default_rng(7)


def _spheres():
    """Scattered ones, a row of equal ones that touch the surface, one pair that overlaps."""
    places = zip(
        RNG.uniform(-4, 4, 8), RNG.uniform(-4, 4, 8), RNG.uniform(1, 4, 8), RNG.uniform(0.2, 1, 8), strict=True
    )
    shapes = [ec.make("sphere", center=(x, y, z), radius=r) for x, y, z, r in np.array(list(places)).tolist()]
    return shapes + [ec.make("sphere", center=(float(i), 0.0, 0.5), radius=0.5) for i in range(4)]


def _lattice(step=0.5):
    line = np.arange(-2.0, 2.01, step)
    return tuple(axis.ravel() for axis in np.meshgrid(line, line, line + 2.0))


@pytest.mark.parametrize("space", ["half", "full"])
@pytest.mark.parametrize("quantity", ["displacement", "strain", "stress"])
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_a_cloud_is_the_sum_of_its_members(space, quantity, nu):
    shapes = _spheres()
    strains = RNG.normal(size=(len(shapes), 6))
    strains[8:] = strains[8]  # equal shapes with equal strain share their work
    given = {"poisson_ratio": nu, "quantity": quantity, "space": space}
    cloud = field_of_cloud(shapes, strains, _lattice(1.0), **given)
    singly = sum(field_at_points(s, e, _lattice(1.0), **given) for s, e in zip(shapes, strains, strict=True))
    assert np.abs(cloud - singly).max() < 1e-13 * np.abs(singly).max()


def test_ellipsoids_and_cuboids_join_a_cloud():
    shapes = [
        ec.make("ellipsoid", center=(0.0, 0.0, 1.5), semi_axes=(1.0, 0.5, 0.4)),
        ec.make("ellipsoid", center=(1.0, 1.0, 1.5), semi_axes=(1.0, 0.5, 0.4)),
        ec.make("cuboid", center=(2.0, 0.0, 1.0), edges=(1.0, 1.0, 2.0)),
    ]
    strains = np.tile([1.0, 0.5, -0.2, 0.3, 0.1, 0.7], (3, 1))
    line = np.array([0.0, 0.7, 3.0, 9.0, 40.0])
    points = tuple(axis.ravel() for axis in np.meshgrid(line, line, line))
    given = {"poisson_ratio": 0.3, "quantity": "stress"}
    cloud = field_of_cloud(shapes, strains, points, **given)
    singly = sum(field_at_points(s, e, points, **given) for s, e in zip(shapes, strains, strict=True))
    assert np.abs(cloud - singly).max() < 1e-11 * np.abs(singly).max()


@pytest.mark.parametrize("space", ["half", "full"])
@pytest.mark.parametrize("quantity", ["displacement", "stress"])
def test_turned_ellipsoids_at_all_distances(space, quantity):
    """From inside to 30 half lengths: every level of their point sources is used, next to the image as well."""
    turned = {"semi_axes": (1.0, 0.6, 0.3), "rotation": (0.3, 0.5, -0.7)}
    shapes = [ec.make("ellipsoid", center=(x, 0.3 * x, z), **turned) for x, z in ((0, 1.02), (2.5, 1.1), (-3.0, 4.0))]
    strains = RNG.normal(size=(3, 6))
    far = shapes[0].far_field()
    reach = np.geomspace(0.05, 1.5 * far.levels[0].distance, 2000)
    line = np.abs(RNG.normal(size=(3, reach.size)))
    points = tuple(line / np.linalg.norm(line, axis=0) * reach)
    points[2][::7] = 0.0
    given = {"poisson_ratio": 0.4, "quantity": quantity, "space": space}
    cloud = field_of_cloud(shapes, strains, points, **given)
    singly = sum(field_at_points(s, e, points, **given) for s, e in zip(shapes, strains, strict=True))
    error = np.linalg.norm(cloud - singly, axis=0) / np.linalg.norm(singly, axis=0)
    assert np.quantile(error, 0.95) < 1e-11  # locally; single points where the three cancel stand out
    assert np.abs(cloud - singly).max() < 1e-12 * np.abs(singly).max()


def test_work_grows_with_the_cloud_not_with_a_loop_over_points():
    """Every near pair is evaluated in a batch: as many calls of a shape's potentials for many points as for few."""
    calls = []

    class Counting:
        def __init__(self, sphere):
            self._sphere = sphere

        bounds = property(lambda self: self._sphere.bounds)

        def phi(self, *args):
            calls.append("phi")
            return self._sphere.phi(*args)

        def psi(self, *args):
            calls.append("psi")
            return self._sphere.psi(*args)

        def far_field(self):
            return self._sphere.far_field()

    shape = Counting(ec.make("sphere", center=(0.0, 0.0, 2.0), radius=1.0))
    counts = []
    for n in (10, 1000):
        calls.clear()
        points = (np.linspace(-3, 3, n), np.linspace(-0.2, 0.2, n), np.linspace(1, 3, n))
        field_of_cloud([shape], np.ones((1, 6)), points, poisson_ratio=0.3, quantity="stress", threads=1)
        counts.append(len(calls))
    assert counts[0] == counts[1] > 0


def test_inclusion_field_takes_several_shapes():
    shapes = _spheres()[:3]
    tensors = RNG.normal(size=(3, 3, 3))
    tensors += tensors.swapaxes(1, 2)
    points = np.column_stack(_lattice())
    given = {"young_modulus": 2.0, "poisson_ratio": 0.3, "quantity": "stress"}
    together = ec.inclusion_field(shapes, tensors, points, **given)
    singly = sum(ec.inclusion_field(s, e, points, **given) for s, e in zip(shapes, tensors, strict=True))
    assert np.abs(together - singly).max() < 1e-13 * np.abs(singly).max()
    alike = ec.inclusion_field(shapes, tensors[0], points, **given)
    assert np.abs(alike - ec.inclusion_field(shapes, [tensors[0]] * 3, points, **given)).max() == 0.0
