"""One uniform eigenstrain an inclusion: exact alone in full space; identities, limits and neighbours otherwise."""

from types import SimpleNamespace

import numpy as np
import pytest

from cell_map import CellMap
from close import close
from eigencontact.core.material import Material
from eigencontact.core.tensors import to_mandel
from eigencontact.errors import NotConverged, SceneError
from eigencontact.halfspace.cloud import field_of_cloud
from eigencontact.halfspace.moments import moment_field
from eigencontact.model.kernels import StressCoefficients
from eigencontact.solvers.polynomial_inclusions import PolynomialInclusions
from eigencontact.solvers.subsurface import stress_at_points
from eigencontact_plugins.laws.cubic import Cubic
from eigencontact_plugins.laws.isotropic import Isotropic
from eigencontact_plugins.laws.stiffness import GivenStiffness
from eigencontact_plugins.laws.void import Void
from eigencontact_plugins.shapes.cuboid import Cuboid
from eigencontact_plugins.shapes.ellipsoid import Ellipsoid
from eigencontact_plugins.shapes.sphere import SphericalInclusion
from eigencontact_plugins.surface_loads import PressureLoad
from eigencontact_verification.oracles.eshelby import infinite_bar, spheroid_tensor
from eigencontact_verification.oracles.eshelby_sphere import (
    cubic_stiffness,
    isotropic_stiffness,
    sphere_in_body,
    turned,
)
from solvers.contacts import UNIT, paraboloid, solve, square_grid

STEEL = Material(young_modulus=210e9, poisson_ratio=0.3)
LOAD = np.array([[3.0, -1.0, 0.5], [-1.0, 2.0, 0.7], [0.5, 0.7, -4.0]]) * 1e8
PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
NICKEL = {"c11": 246.5e9, "c12": 147.3e9, "c44": 124.7e9}


class WholeInclusions:
    """The system of degree 0; loads and answers as means over each inclusion."""

    def __init__(self, shapes, matrix, materials, *, space="half", threads=1):
        self.system = PolynomialInclusions(shapes, matrix, materials, [0] * len(shapes), space=space, threads=threads)

    def mean(self, stress):
        ends = np.cumsum([len(points) for points, _ in self.system.rules])[:-1]
        parts = np.split(stress, ends, axis=1)
        return np.array([p @ w / w.sum() for p, (_, w) in zip(parts, self.system.rules, strict=True)]).T

    def solve(self, load, prestrain=None, **options):
        """Eigenstrain and the mean of the total stress, from the fields of all."""
        system = self.system
        stress = np.repeat(load, [len(points) for points, _ in system.rules], axis=1)
        answer = system.solve(system.moments(stress), prestrain, **options)
        for shape, eigenstrain in zip(system.shapes, answer.eigenstrain.transpose(2, 0, 1), strict=True):
            stress = stress + system.matrix.shear_modulus * moment_field(
                shape, eigenstrain, tuple(system.points), degree=0, poisson_ratio=system.matrix.poisson_ratio,
                quantity="stress", space=system.space, threads=1,
            )  # fmt: skip
        return SimpleNamespace(
            eigenstrain=answer.eigenstrain[:, 0], stress=self.mean(stress), report=answer.report,
            amplitudes=answer.amplitudes,
        )  # fmt: skip


def mandel(tensor):
    return to_mandel([tensor[pair] for pair in PAIRS])


def columns(tensor, count=1):
    return np.repeat(mandel(np.asarray(tensor, dtype=float))[:, None], count, axis=1)


def ball(x=0.0, y=0.0, z=3.0, radius=1.0):
    return SphericalInclusion(center=(x, y, z), radius=radius)


def times_steel(ratio, poisson_ratio=0.3):
    return Isotropic(young_modulus=ratio * 210e9, poisson_ratio=poisson_ratio)


@pytest.mark.parametrize("ratio", [0.0, 0.1, 0.5, 2.0, 4.0, 1e6])
def test_eshelby(ratio):
    """Any stress at infinity and a prestrain: stress and eigenstrain of the closed form."""
    prestrain = 1e-3 * np.diag([1.0, 2.0, -1.0])
    stress, eigenstrain = sphere_in_body(isotropic_stiffness(ratio * 210e9, 0.2), 210e9, 0.3, LOAD, prestrain)
    answer = WholeInclusions([ball()], STEEL, [times_steel(ratio, 0.2)], space="full").solve(
        columns(LOAD), columns(prestrain), tolerance=1e-12
    )
    np.testing.assert_allclose(answer.stress[:, 0], mandel(stress), atol=1e-10 * 210e9 * 1e-3)
    np.testing.assert_allclose(answer.eigenstrain[:, 0], mandel(eigenstrain), atol=1e-10 * 1e-3)


@pytest.mark.parametrize(
    ("ratio", "along", "across", "hydrostatic"),
    [(0.5, 0.6789, 0.0226, 0.7241), (2, 1.315, -0.0398, 1.2353), (4, 1.5647, -0.0824, 1.4),
     (1e9, 1.9385, -0.1615, 1.6154)],
)  # fmt: skip
def test_published_stress_in_a_sphere(ratio, along, across, hydrostatic):
    alone = WholeInclusions([ball()], STEEL, [times_steel(ratio)], space="full")
    np.testing.assert_allclose(
        alone.solve(columns(np.diag([1.0, 0, 0]))).stress[:3, 0], [along, across, across], atol=5e-5
    )
    np.testing.assert_allclose(alone.solve(columns(np.eye(3))).stress[:3, 0], hydrostatic, atol=5e-5)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_crystal_in_any_orientation(seed):
    R, _ = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    R *= np.sign(np.linalg.det(R))
    crystal = Cubic(**NICKEL, x_axis=tuple(R[:, 0]), y_axis=tuple(R[:, 1]))
    stress, _ = sphere_in_body(turned(cubic_stiffness(**NICKEL), R), 210e9, 0.3, LOAD)
    answer = WholeInclusions([ball()], STEEL, [crystal], space="full").solve(columns(LOAD), tolerance=1e-12)
    np.testing.assert_allclose(answer.stress[:, 0], mandel(stress), atol=1e-10 * 4e8)
    # Turned together with the load it is the crystal along the axes.
    straight = WholeInclusions([ball()], STEEL, [Cubic(**NICKEL)], space="full").solve(columns(R.T @ LOAD @ R))
    back = R @ (tensor_of(straight.stress[:, 0])) @ R.T
    np.testing.assert_allclose(answer.stress[:, 0], mandel(back), atol=1e-7 * 4e8)


def tensor_of(vector):
    out = np.zeros((3, 3))
    for value, (i, j), weight in zip(vector, PAIRS, [1, 1, 1, 2, 2, 2], strict=True):
        out[i, j] = out[j, i] = value / np.sqrt(weight)
    return out


@pytest.mark.parametrize("aspect", [0.3, 4.0])
def test_spheroids_have_their_own_tensor(aspect):
    """Rigid, in simple tension: total strain e0 + S e* = 0."""
    rod = Ellipsoid(center=(0.0, 0.0, 9.0), semi_axes=(aspect, 1.0, 1.0))
    answer = WholeInclusions([rod], STEEL, [times_steel(1e12)], space="full").solve(columns(np.diag([1e8, 0, 0])))
    far = np.diag([1.0, -0.3, -0.3]) * 1e8 / 210e9
    S = spheroid_tensor(aspect, 0.3)
    strain = np.einsum("ijkl,kl->ij", S, tensor_of(answer.eigenstrain[:, 0]))
    np.testing.assert_allclose(strain, -far, atol=1e-10 * np.abs(far).max())


@pytest.mark.parametrize("space", [pytest.param("half", marks=pytest.mark.slow), "full"])
def test_the_same_constants_change_nothing(space):
    shapes = [ball(), ball(2.001), Ellipsoid(center=(0.0, 2.5, 2.2), semi_axes=(0.5, 1.0, 2.0), rotation=(0.1, 0, 0.2))]
    answer = WholeInclusions(shapes, STEEL, [times_steel(1.0)] * 3, space=space).solve(columns(LOAD, 3))
    assert np.abs(answer.eigenstrain).max() < 1e-10 * 4e8 / 210e9
    misfit = np.random.default_rng(0).standard_normal((6, 3))
    answer = WholeInclusions(shapes, STEEL, [times_steel(1.0)] * 3, space=space).solve(columns(LOAD, 3), misfit)
    np.testing.assert_allclose(answer.eigenstrain, misfit, atol=1e-10)


def test_far_apart_is_alone_and_the_surface_is_forgotten():
    """Neighbours and the surface act by the cube of the distance."""
    alone = WholeInclusions([ball()], STEEL, [times_steel(3.0)], space="full").solve(columns(LOAD)).eigenstrain
    gaps = []
    for distance in (5.0, 20.0):
        pair = [ball(0, 0, 2 * distance), ball(distance, 0, 2 * distance)]
        found = WholeInclusions(pair, STEEL, [times_steel(3.0)] * 2).solve(columns(LOAD, 2)).eigenstrain
        gaps.append(np.abs(found - alone).max() / np.abs(alone).max())
    assert gaps[1] < 1e-3
    assert 2.7 < np.log(gaps[0] / gaps[1]) / np.log(4.0) < 3.3


@pytest.mark.parametrize(("length", "pascal"), [(1e-9, 1.0), (1.0, 1e9), (1e3, 1e-9)])
def test_units_do_not_matter(length, pascal):
    def found(length, pascal):
        matrix = Material(young_modulus=2.1 * pascal, poisson_ratio=0.3)
        shapes = [ball(0, 0, 1.2 * length, length), ball(2.2 * length, 0, 1.5 * length, 0.9 * length)]
        materials = [Isotropic(young_modulus=9 * pascal, poisson_ratio=0.2), Void()]
        return WholeInclusions(shapes, matrix, materials).solve(columns(LOAD / 1e8, 2) * pascal).eigenstrain

    np.testing.assert_allclose(found(length, pascal), found(1.0, 1.0), rtol=1e-7, atol=1e-7)


def test_voids_and_rigid_ones_next_to_each_other_and_to_the_surface():
    shapes = [ball(2.05 * i, 2.05 * j, 1.02) for i in range(3) for j in range(3)]
    materials = [Void() if n % 2 else times_steel(1e6) for n in range(9)]
    answer = WholeInclusions(shapes, STEEL, materials).solve(columns(LOAD, 9))
    assert answer.report.iterations < 40
    assert answer.report.holds
    assert np.abs(answer.stress[:, 1::2]).max() < 5e-3 * 4e8  # means over few points, with gaps of 0.05 radii
    load = WholeInclusions(shapes, STEEL, materials)
    again = load.solve(columns(LOAD, 9), start=answer.amplitudes)
    assert again.report.iterations == 0


@pytest.mark.slow
def test_the_mean_of_a_load_is_that_over_the_volume():
    """x² over a ball is a²/5, over an ellipsoid likewise along its axes, over a cuboid h²/3."""
    flat = Ellipsoid(center=(0.0, 0.0, 3.0), semi_axes=(1.0, 2.0, 0.5))
    brick = Cuboid(center=(0.0, 0.0, 3.0), edges=(2.0, 1.0, 1.0))
    whole = WholeInclusions([ball(radius=2.0), flat, brick], STEEL, [Void()] * 3)
    x, y, z = whole.system.points
    squares = np.array([x * x, y * y, (z - 3) ** 2, x, z, x**4 - 6 * x * x * y * y + y**4])
    found = whole.mean(squares)
    np.testing.assert_allclose(found[:, 0], [0.8, 0.8, 0.8, 0, 3, 0], atol=1e-12)
    np.testing.assert_allclose(found[:5, 1], [0.2, 0.8, 0.05, 0, 3], atol=1e-12)
    np.testing.assert_allclose(found[:5, 2], [1 / 3, 1 / 12, 1 / 12, 0, 3], atol=1e-12)


def test_cuboids_have_one_eigenstrain_too():
    """Of a cube: the mean of its own stress is that of the ball, by symmetry under turns of a quarter."""
    cube = Cuboid(center=(0.0, 0.0, 9.0), edges=(2.0, 2.0, 2.0))
    bodies = [times_steel(3.0)]
    found, expected = (
        WholeInclusions([shape], STEEL, bodies, space="full").solve(columns(np.eye(3))) for shape in (cube, ball(z=9.0))
    )
    scale = np.abs(expected.eigenstrain).max()  # the mean over a cuboid is that of eight points
    np.testing.assert_allclose(found.eigenstrain, expected.eigenstrain, rtol=0, atol=1e-4 * scale)
    with pytest.raises(SceneError, match="degree must be 0"):
        PolynomialInclusions([cube], STEEL, bodies, [1])


def test_a_long_ellipsoid_is_a_bar():
    """Case PB-1: 1 % of axial eigenstrain in 210 GPa within 50 GPa."""
    bar = Ellipsoid(center=(0.0, 0.0, 5.0), semi_axes=(200.0, 1.0, 1.0))
    matrix, steel = Material(young_modulus=50e9, poisson_ratio=0.3), Isotropic(young_modulus=210e9, poisson_ratio=0.3)
    found = WholeInclusions([bar], matrix, [steel], space="full").solve(
        np.zeros((6, 1)), columns(np.diag([0.01, 0, 0]))
    )
    expected = infinite_bar(0.01, (210e9, 0.3), (50e9, 0.3))
    assert found.stress[0, 0] == close(expected.axial, rel=2e-3)
    assert found.stress[1, 0] == close(expected.transverse, rel=2e-2)
    assert found.stress[0, 0] == close(-2163e6, rel=2e-3)


def test_refusals_and_what_did_not_converge():
    one = WholeInclusions([ball(), ball(2.1)], STEEL, [Void(), times_steel(1e4)])
    with pytest.raises(NotConverged, match="after 2 iterations") as caught:
        one.solve(columns(LOAD, 2), max_iterations=2, tolerance=1e-12)
    assert len(caught.value.report.history) == 2
    for make, message in (
        (lambda: WholeInclusions([ball()], STEEL, []), "one for each of 1 inclusions"),
        (lambda: WholeInclusions([], STEEL, []), "at least one"),
        (lambda: WholeInclusions([ball()], STEEL, [CellMap(np.ones(1), np.ones(1))]), "cells"),
        (lambda: WholeInclusions([ball()], STEEL, [GivenStiffness(stiffness=np.eye(3))]), "6 x 6"),
    ):
        with pytest.raises(SceneError, match=message):
            make()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("radius", "depth", "ratio", "pressure"),
    [(0.17, 0.5, 2.0, 1.054), (0.13, 0.3, 2.0, 1.104), (0.13, 0.4, 2.0, 1.047), (0.13, 0.5, 2.0, 1.024),
     (0.17, 0.5, 0.5, 0.948)],
)  # fmt: skip
def test_one_sphere_under_a_contact(radius, depth, ratio, pressure):
    """Cases IC-3 to IC-5: pressure in the middle over Hertz's, lengths in contact radii."""
    grid, kernel = square_grid(16, 1.3, (0.5, 0.5)), [StressCoefficients(PressureLoad(), UNIT)]
    middle = (np.abs(grid.y).argmin(), np.abs(grid.x).argmin())
    x, y = (values.ravel() for values in np.meshgrid(grid.x, grid.y))
    assert np.hypot(grid.x[middle[1]], grid.y[middle[0]]) < 1e-9
    buried = ball(z=depth, radius=radius)
    inside = [Isotropic(young_modulus=ratio * UNIT.young_modulus, poisson_ratio=0.3)]
    whole = WholeInclusions([buried], UNIT, inside, threads=1)
    contact = hertz = solve(grid, paraboloid(grid), normal_load=4 / 3)
    for _ in range(5):
        load = whole.mean(stress_at_points(grid, kernel, [contact.pressure], whole.system.points.T, threads=1))
        eigenstrain = whole.solve(load).eigenstrain
        lift = field_of_cloud(
            [buried], eigenstrain.T, (x, y, 0 * x), poisson_ratio=0.3, quantity="displacement", threads=1
        )[2]
        separation = paraboloid(grid) + lift.reshape(contact.pressure.shape)
        contact = solve(grid, separation, normal_load=4 / 3, tolerance=1e-7, start=contact.pressure)
    assert contact.pressure[middle] / hertz.pressure[middle] == close(pressure, abs=0.005)
