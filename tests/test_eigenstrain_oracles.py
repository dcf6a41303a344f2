"""The oracles of eigenstrain against each other, against equilibrium and against published numbers."""

from functools import cache

import numpy as np
import pytest

from close import close
from eigencontact_verification.oracles import cuboid_quadrature, eshelby, mindlin, volume_quadrature
from eigencontact_verification.oracles.eshelby import apply, sphere_tensor
from eigencontact_verification.oracles.eshelby_sphere import isotropic_stiffness, stress_about_sphere

POISSON = (0.0, 0.3, 0.49, 0.4999999, 0.5)
COMPONENTS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
TURN = np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3


def unit(i, j):
    e = np.zeros((3, 3))
    e[i, j] = e[j, i] = 1.0
    return e


UNITS = [unit(*pair) for pair in COMPONENTS]


def worst(a, b):
    return float(np.abs(a - b).max() / np.abs(b).max())


def stress_of_point_force(field, source, nu):
    """Stress / N of the three unit forces, by complex steps of the displacement; (i, j, force)."""
    step = 1e-30
    slope = np.stack(
        [mindlin.green(np.asarray(field) + 1j * step * axis, source, nu).imag / step for axis in np.eye(3)], axis=1
    )
    dilatation = np.einsum("iif->f", slope) / (1 - 2 * nu)
    return slope + np.swapaxes(slope, 0, 1) + 2 * nu * np.eye(3)[:, :, None] * dilatation


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
@pytest.mark.parametrize("source", [(0.3, -0.2, 0.7), (0.0, 0.0, 1e-3), (1.0, 2.0, 40.0)])
def test_point_force_leaves_the_surface_free_and_is_reciprocal(source, nu):
    field = np.array([0.9, 0.4, 0.0])
    stress = stress_of_point_force(field, source, nu)
    assert np.abs(stress[:, 2]).max() <= 2e-14 / (1 - 2 * nu) * np.abs(stress).max()
    deep = np.array([0.9, 0.4, 1.3])
    np.testing.assert_allclose(
        mindlin.green(deep, source, nu), mindlin.green(source, deep, nu).T, rtol=1e-12, atol=1e-14
    )


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
def test_point_force_is_carried_by_a_closed_surface_around_it(nu):
    source = np.array([0.1, -0.2, 0.8])
    points, area = volume_quadrature.ellipsoid_boundary(source, (0.6, 0.6, 0.6), None, 24)
    total = sum(
        np.einsum("ijf,j->if", stress_of_point_force(p, source, nu), a) for p, a in zip(points, area, strict=True)
    )
    np.testing.assert_allclose(total, -np.eye(3), atol=1e-12)


@pytest.mark.parametrize("row", eshelby.SURFACE_OF_BURIED_CUBE, ids=lambda row: row[0])
def test_cube_below_a_surface_point(row):
    _, eigenstrain, expected, digit = row
    moments = cuboid_quadrature.moments([(0, 0, 0)], (2, 1, 5), (1, 1, 1))
    found = mindlin.displacement(moments, eigenstrain, 0.3)[0]
    assert (np.abs(found - expected) <= 0.51 * np.array(digit)).all()


CUBOIDS = {
    "flush": ((0.0, 0.0, 0.5), (1.0, 1.0, 1.0)),
    "shallow": ((0.1, -0.2, 0.5), (1.0, 1.3, 0.7)),
    "long": ((0.0, 0.0, 0.8), (8.0, 1.0, 1.0)),
}


@pytest.mark.parametrize(
    ("name", "space"),
    [("flush", "half"), ("shallow", "half"), pytest.param("long", "half", marks=pytest.mark.slow), ("shallow", "full")],
)
def test_faces_against_volume_outside(name, space):
    center, edges = CUBOIDS[name]
    points = [(0.2, 2.1, 0.0), (0.5, 0.1, 3.4)]
    rule = volume_quadrature.cuboid_nodes(center, edges, (40 if name == "long" else 12, 12, 12))
    faces = cuboid_quadrature.moments(points, center, edges, space)
    volume = volume_quadrature.volume_moments(points, rule, space)
    assert worst(faces, volume) <= 2e-12


def test_gradients_of_faces_against_volume_outside():
    center, edges = CUBOIDS["shallow"]
    points = [(0.2, 2.1, 0.0), (0.5, 0.1, 3.4)]
    faces = cuboid_quadrature.gradient_moments(points, center, edges)
    volume = volume_quadrature.volume_moments(points, volume_quadrature.cuboid_nodes(center, edges, 10), gradient=True)
    assert worst(faces, volume) <= 2e-12


NEAR = [
    (0.1, 0.2, 0.3),  # inside
    (0.1, 0.2, 1e-9),  # just below the free face
    (0.1, 0.2, 0.0),  # on the free face
    (0.5, 0.2, 0.3),  # on a face
    (0.5, 0.5, 0.2),  # on an edge
    (0.5, 0.5, 1.0),  # on a corner
    (0.5, 0.7, 0.0),  # in line with a face, on the surface
    (0.5, 0.5, 1.7),  # in line with an edge
    (0.0, 0.0, 3.0),  # on an axis
]


@pytest.mark.slow
@pytest.mark.parametrize("point", NEAR)
def test_faces_have_converged(point):
    center, edges = CUBOIDS["flush"]
    usual = cuboid_quadrature.moments([point], center, edges)
    assert worst(usual, cuboid_quadrature.moments([point], center, edges, gauss=24)) <= 5e-14
    if point not in ((0.5, 0.5, 0.2), (0.5, 0.5, 1.0)):  # the strain is infinite there
        usual = cuboid_quadrature.gradient_moments([point], center, edges)
        finer = cuboid_quadrature.gradient_moments([point], center, edges, gauss=24)
        assert worst(usual, finer) <= 2e-13


@cache
def face_gradients(name, *points, space="half"):
    """Moments of all ratios of Poisson at once: gradients at points of a cuboid."""
    return cuboid_quadrature.gradient_moments(points, *CUBOIDS[name], space)


@cache
def spheroid_gradients(center, aspect, *points, space="half"):
    """Moments of all ratios of Poisson at once: gradients at points of a spheroid about x, radius 1."""
    rule = volume_quadrature.ellipsoid_boundary(center, (aspect, 1, 1), None, 48)
    return volume_quadrature.boundary_moments(points, rule, space, gradient=True)


@pytest.mark.parametrize("nu", POISSON)
def test_flush_cube_has_no_traction_on_the_surface(nu):
    center, edges = CUBOIDS["flush"]
    points = [(0.1, 0.2, 0.0), (0.3, -0.45, 0.0), (0.7, 0.2, 0.0), (2.0, 2.0, 0.0)]
    gradients = face_gradients("flush", *points)
    share = cuboid_quadrature.inside(points, center, edges)
    assert share.tolist() == [1, 1, 0, 0]
    for eigenstrain in UNITS:
        stress = mindlin.stress(gradients, eigenstrain, nu, share)
        assert np.abs(stress[:, :, 2]).max() <= 2e-13 * np.abs(stress).max()
        assert mindlin.dilatation_defect(gradients, eigenstrain, nu, share)[1] <= 5e-12


@pytest.mark.parametrize("nu", POISSON)
def test_stress_jumps_across_a_face_as_equilibrium_demands(nu):
    """Across x = const: no jump of the traction; a face's value is the mean of both sides."""
    center, edges = CUBOIDS["shallow"]
    x = center[0] + edges[0] / 2
    points = [(x - 1e-12, 0.1, 0.4), (x, 0.1, 0.4), (x + 1e-12, 0.1, 0.4)]
    gradients = face_gradients("shallow", *points)
    share = cuboid_quadrature.inside([(x - 1e-3, 0.1, 0.4), (x, 0.1, 0.4), (x + 1e-3, 0.1, 0.4)], center, edges)
    assert share.tolist() == [1, 0.5, 0]
    for eigenstrain in UNITS:
        below, on, above = mindlin.stress(gradients, eigenstrain, nu, share)
        np.testing.assert_allclose(above[0], below[0], atol=1e-10)
        np.testing.assert_allclose(on, (above + below) / 2, atol=1e-10)
        if eigenstrain[1, 1]:
            assert above[1, 1] - below[1, 1] == close(2 / (1 - nu), abs=1e-10)


@pytest.mark.parametrize("nu", POISSON)
@pytest.mark.parametrize("aspect", [1.0, 3.0, 0.6])
def test_spheroids_in_full_space(aspect, nu):
    gradients = spheroid_gradients((0, 0, 0), aspect, (0.0, 0.0, 0.0), (0.1, 0.05, -0.1), space="full")
    tensor = eshelby.sphere_tensor(nu) if aspect == 1 else eshelby.spheroid_tensor(aspect, nu)
    for eigenstrain in UNITS:
        found = mindlin.strain(gradients, eigenstrain, nu)
        np.testing.assert_allclose(found, np.stack([eshelby.apply(tensor, eigenstrain)] * 2), atol=1e-11)


@pytest.mark.parametrize(
    ("rule", "volume"),
    [
        (volume_quadrature.ball_nodes((0, 0, 2), 0.7), 4 / 3 * np.pi * 0.7**3),
        (volume_quadrature.ellipsoid_nodes((0, 0, 2), (0.5, 0.8, 0.3), TURN), 4 / 3 * np.pi * 0.12),
        (volume_quadrature.torus_nodes((0, 0, 2), 0.6, 0.2), 2 * np.pi**2 * 0.6 * 0.04),
        (volume_quadrature.cuboid_nodes((0, 0, 2), (1, 2, 3)), 6.0),
    ],
    ids=["ball", "ellipsoid", "torus", "cuboid"],
)
def test_volume_rules_hold_the_volume_and_its_centre(rule, volume):
    positions, weights = rule
    assert weights.sum() == close(volume, rel=1e-13)
    np.testing.assert_allclose(weights @ positions / volume, (0, 0, 2), atol=1e-13)


@pytest.mark.parametrize("space", ["half", pytest.param("full", marks=pytest.mark.slow)])
@pytest.mark.parametrize("shape", [pytest.param("ellipsoid", marks=pytest.mark.slow), "torus"])
def test_boundary_against_volume(shape, space):
    center, points = (0.2, -0.1, 2.0), [(2.5, 1.0, 3.0), (0.3, 0.4, 0.0)]
    if shape == "torus":
        boundary = volume_quadrature.torus_boundary(center, 0.6, 0.2, 32)
        volume = volume_quadrature.torus_nodes(center, 0.6, 0.2, 16)
    else:
        boundary = volume_quadrature.ellipsoid_boundary(center, (0.5, 0.8, 0.3), TURN, 28)
        volume = volume_quadrature.ellipsoid_nodes(center, (0.5, 0.8, 0.3), TURN, 14)
    found = volume_quadrature.boundary_moments(points, boundary, space)
    assert worst(found, volume_quadrature.volume_moments(points, volume, space)) <= 1e-12


@cache
def ball_moments(center, *points):
    """Moments of all ratios of Poisson at once: displacement at points of a ball of radius 1."""
    return volume_quadrature.boundary_moments(points, volume_quadrature.ellipsoid_boundary(center, (1, 1, 1), None, 48))


@pytest.mark.parametrize("nu", POISSON)
def test_dilatational_ball_in_the_half_space(nu):
    center, points = (0.0, 0.0, 1.2), [(0.0, 0.1, 1.3), (2.0, 1.0, 0.0), (1.5, 0.2, 2.6)]
    moments = ball_moments(center, *points)
    gradients = spheroid_gradients(center, 1, *points)
    displacement = mindlin.displacement(moments, np.eye(3), nu)
    closed = eshelby.dilatational_ball_displacement(points, center, 1.0, 1.0, nu)
    assert worst(closed, displacement) <= 2e-11
    stress = mindlin.stress(gradients, np.eye(3), nu, (1.0, 0.0, 0.0))
    assert worst(eshelby.dilatational_ball_stress(points, center, 1.0, 1.0, nu), stress) <= 2e-10


def test_tangent_ball_on_its_axis():
    depth, sigma_xx, sigma_zz = np.array(eshelby.TANGENT_BALL_AXIS).T
    points = np.stack([0 * depth, 0 * depth, np.where(depth == 0, -1e-12, depth)], axis=1)
    stress = eshelby.dilatational_ball_stress(points, (0, 0, 1), 1.0, 1.0, 0.3) / (2 * 1.3 / 0.7)
    np.testing.assert_allclose(stress[:, 0, 0], sigma_xx, atol=5e-6)
    np.testing.assert_allclose(stress[:, 2, 2], sigma_zz, atol=1e-6)


@pytest.mark.parametrize(("depth", "expected"), [(1.0, 2.476), (1.5, 0.7337), (2.0, 0.3095), (3.0, 0.0917)])
def test_surface_above_the_ball(depth, expected):
    tension, uplift = eshelby.dilatational_ball_surface(depth, 1.0, 1.0, 0.3)
    assert tension == close(expected, abs=5e-5 if depth > 1 else 5e-4)
    above = [(0, 0, -1e-12)]
    stress = eshelby.dilatational_ball_stress(above, (0, 0, depth), 1.0, 1.0, 0.3, 1 / 2.6)[0]
    assert stress[0, 0] == close(tension, rel=1e-10)
    if depth > 1:
        moved = eshelby.dilatational_ball_displacement(above, (0, 0, depth), 1.0, 1.0, 0.3)
        assert -moved[0, 2] == close(uplift, rel=1e-10)


def test_cube_centre():
    tensor = eshelby.cube_centre_tensor(0.3)
    np.testing.assert_allclose(
        (tensor[0, 0, 0, 0], tensor[0, 0, 1, 1], tensor[0, 1, 0, 1]), (0.595871, 0.011588, 0.202065), atol=1e-6
    )
    gradients = cuboid_quadrature.gradient_moments([(0, 0, 0)], (0, 0, 0), (1, 1, 1), "full")
    for eigenstrain in UNITS:
        np.testing.assert_allclose(
            mindlin.strain(gradients, eigenstrain, 0.3)[0], eshelby.apply(tensor, eigenstrain), atol=1e-13
        )


def test_long_bar():
    """Published values, and the equivalent bar against Eshelby's tensor of a needle."""
    bar = eshelby.infinite_bar(0.01, (210e9, 0.3), (50e9, 0.3))
    assert (bar.axial, bar.transverse, bar.von_mises) == close((-2163e6, -105.4e6, 2058e6), rel=5e-4)
    elastic = eshelby.apply(eshelby.spheroid_tensor(1e4, 0.3), bar.equivalent) - bar.equivalent
    mu = 50e9 / 2.6
    stress = 2 * mu * (elastic + 0.75 * np.trace(elastic) * np.eye(3))
    np.testing.assert_allclose(stress, np.diag([bar.axial, bar.transverse, bar.transverse]), atol=1e-6 * bar.von_mises)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.45])
def test_stress_about_a_sphere(nu):
    """On the sphere its traction is that inside; outside it is in equilibrium, by differences."""
    rng = np.random.default_rng(3)
    eigenstrain = rng.normal(size=(3, 3))
    eigenstrain += eigenstrain.T
    way = rng.normal(size=(9, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    inside = apply(isotropic_stiffness(2.0, nu), apply(sphere_tensor(nu), eigenstrain) - eigenstrain)
    outside = stress_about_sphere(eigenstrain, 2.0, nu, way)
    np.testing.assert_allclose(np.einsum("ijn,nj->ni", outside, way), way @ inside, atol=1e-13)
    step, points = 1e-4, 1.4 * way
    sides = [
        [stress_about_sphere(eigenstrain, 2.0, nu, points + sign * step * np.eye(3)[j])[:, j] for sign in (1, -1)]
        for j in range(3)
    ]
    assert np.abs(sum(ahead - behind for ahead, behind in sides)).max() / (2 * step) < 1e-6
