"""Fields of inclusions against quadrature of Mindlin's point force, closed forms, and what holds for every field."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eigencontact
from close import close
from eigencontact.core.tensors import to_matrix
from eigencontact.halfspace.points import unit_fields_at_points
from eigencontact_verification.oracles import cuboid_quadrature, eshelby, mindlin, volume_quadrature

POISSON = (0.0, 0.3, 0.49, 0.4999999, 0.5)
every_nu = pytest.mark.parametrize("nu", POISSON)


def with_every_nu(names, quick, slow=()):
    """Every shape with every nu; the shapes in `quick` in the default suite, of others not in `slow` nu = 0.3 alone."""
    return pytest.mark.parametrize(
        ("name", "nu"),
        [
            pytest.param(name, nu, marks=() if name in quick or (nu == 0.3 and name not in slow) else pytest.mark.slow)
            for name in names
            for nu in POISSON
        ],
    )


def unit(i, j):
    e = np.zeros((3, 3))
    e[i, j] = e[j, i] = 1.0
    return e


UNITS = [unit(*pair) for pair in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]


def fields(shape, points, nu, quantity, space="half"):
    """Fields of the six unit eigenstrains, with the potentials evaluated once; stress in units of the shear modulus."""
    columns = tuple(np.asarray(points, dtype=float).T)
    found = unit_fields_at_points(shape, columns, poisson_ratio=nu, quantity=quantity, space=space)
    tensors = found.swapaxes(1, 2) if quantity == "displacement" else to_matrix(found.swapaxes(0, 1))
    return tensors * np.array([1.0, 1.0, 1.0, *[np.sqrt(2.0)] * 3]).reshape(6, *[1] * (tensors.ndim - 1))


def field(shape, eigenstrain, points, nu, quantity="displacement", space="half"):
    return eigencontact.inclusion_field(
        shape,
        eigenstrain,
        points,
        young_modulus=2 * (1 + nu),
        poisson_ratio=nu,
        quantity=quantity,
        space=space,
    )


def at_points(values):
    """Largest component of six fields at each point."""
    return np.abs(values).max(axis=(0, *range(2, values.ndim)))


def worst(found, expected):
    """Largest error at a point over the largest component of the six fields there (points of no field left out)."""
    size = at_points(expected)
    some = size > 1e-12 * np.median(size)
    return (at_points(found - expected)[some] / size[some]).max()


def worst_of_all(found, expected):
    """Largest error over the largest component at any point."""
    return np.abs(found - expected).max() / np.abs(expected).max()


# ---------------------------------------------------------------------------------------------- cuboids, near and on
CUBOIDS = {
    "flush": ((0.0, 0.0, 0.5), (1.0, 1.0, 1.0)),
    "shallow": ((0.1, -0.2, 0.5), (1.0, 1.3, 0.7)),
    "deep": ((0.0, 0.0, 20.0), (1.0, 1.5, 2.0)),
    "1000 long": ((0.0, 0.0, 1.0), (1000.0, 1.0, 1.0)),
    "1000 tall": ((0.0, 0.0, 500.0), (1.0, 1.0, 1000.0)),
    "1000 wide": ((0.0, 0.0, 0.5), (1000.0, 1000.0, 1.0)),
}
every_cuboid = with_every_nu(CUBOIDS, ("flush", "1000 long"), slow=("1000 tall", "1000 wide"))

# Offsets from the centre in half edges.
SMOOTH = [
    (0.2, 0.3, 0.1),  # inside
    (0.0, 0.0, 0.0),  # middle
    (1.0, 0.2, 0.3),  # on faces
    (0.2, 0.1, 1.0),
    (0.3, -0.2, -1.0),
    (1.0, 1.6, 0.3),  # in line with a face
    (2.5, 1.0, 1.0),  # in line with edges
    (1.0, 1.0, 3.0),
    (0.0, 0.0, 1.7),  # axes
    (1.8, 0.0, 0.0),
    (0.0, 3.0, 0.0),
    (1.0 + 1e-7, 0.4, 0.1),  # close to a face, to an edge
    (1.001, 1.001, 1.0),
    (3.0, 2.0, 1.4),
    (6.0, 0.0, 0.0),
]
SURFACE = [(0.0, 0.0), (0.3, 0.2), (2.0, 1.0), (3.0, -2.0)]
SINGULAR = [(1.0, 1.0, 0.4), (1.0, 0.3, -1.0), (1.0, 1.0, 1.0), (-1.0, -1.0, -1.0), (1.0, -1.0, -1.0)]  # edges, corners


def places(name, *, singular):
    center, half = np.array(CUBOIDS[name][0]), np.array(CUBOIDS[name][1]) / 2
    points = center + half * np.array(SMOOTH + SINGULAR * singular)
    surface = np.array([(center[0] + half[0] * u, center[1] + half[1] * v, 0.0) for u, v in SURFACE])
    return np.vstack([points[points[:, 2] >= 0], surface])


@cache
def moments(name, space):
    return cuboid_quadrature.moments(places(name, singular=True), *CUBOIDS[name], space)


@cache
def gradients(name, space):
    points = places(name, singular=False)
    return cuboid_quadrature.gradient_moments(points, *CUBOIDS[name], space)


def cuboid(name):
    center, edges = CUBOIDS[name]
    return eigencontact.make("cuboid", center=center, edges=edges)


def check_displacement(name, nu, space):
    found = fields(cuboid(name), places(name, singular=True), nu, "displacement", space)
    expected = np.array([mindlin.displacement(moments(name, space), e, nu) for e in UNITS])
    assert worst_of_all(found, expected) <= 2e-12
    # a plate as long as 1000 thicknesses has points where displacement itself is a difference of large terms
    assert worst(found, expected) <= (1e-9 if name == "1000 wide" else 1e-10)


@every_cuboid
def test_displacement_of_cuboids(name, nu):
    check_displacement(name, nu, "half")


@with_every_nu(["flush", "shallow", "1000 long"], ("shallow",), slow=("1000 long",))
def test_displacement_of_cuboids_in_full_space(name, nu):
    check_displacement(name, nu, "full")


@with_every_nu(CUBOIDS, ("flush",), slow=("1000 long", "1000 tall", "1000 wide", "deep"))
def test_strain_and_stress_of_cuboids(name, nu):
    points = places(name, singular=False)
    share = cuboid_quadrature.inside(points, *CUBOIDS[name])
    integrals = gradients(name, "half")
    expected = np.array([mindlin.strain(integrals, e, nu) for e in UNITS])
    assert worst(fields(cuboid(name), points, nu, "strain"), expected) <= 1e-10
    expected = np.array([mindlin.stress(integrals, e, nu, share) for e in UNITS])
    assert worst(fields(cuboid(name), points, nu, "stress"), expected) <= 1e-10


@pytest.mark.parametrize("nu", [0.3, 0.5])
@pytest.mark.parametrize("name", ["shallow", "flush"])
def test_stress_of_cuboids_in_full_space(name, nu):
    points = places(name, singular=False)
    share = cuboid_quadrature.inside(points, *CUBOIDS[name], "full")
    expected = np.array([mindlin.stress(gradients(name, "full"), e, nu, share) for e in UNITS])
    assert worst(fields(cuboid(name), points, nu, "stress", "full"), expected) <= 1e-10


@pytest.mark.parametrize("row", eshelby.SURFACE_OF_BURIED_CUBE, ids=lambda row: row[0])
def test_cube_below_a_surface_point(row):
    """CB-1 and CB-2."""
    _, eigenstrain, expected, digit = row
    cube = eigencontact.make("cuboid", center=(2, 1, 5), edges=(1, 1, 1))
    found = field(cube, eigenstrain, [(0, 0, 0)], 0.3)[0]
    assert (np.abs(found - expected) <= 0.51 * np.array(digit)).all()


def test_surface_directly_above_a_cube():
    """CB-2."""
    cube = eigencontact.make("cuboid", center=(0, 0, 5), edges=(1, 1, 1))
    found = fields(cube, [(0, 0, 0)], 0.3, "displacement")[:, 0, 2]
    np.testing.assert_allclose(found, (1.20882e-3, 1.20882e-3, -1.896784e-2, 0, 0, 0), atol=5.1e-9)


def test_cube_centre_tensor():
    """ES-2."""
    cube = eigencontact.make("cuboid", center=(3, 2, 1), edges=(2, 2, 2))
    found = fields(cube, [(3, 2, 1)], 0.3, "strain", "full")[:, 0]
    expected = [eshelby.apply(eshelby.cube_centre_tensor(0.3), e) for e in UNITS]
    np.testing.assert_allclose(found, expected, atol=1e-14)


# ---------------------------------------------------------------------------------------------------- far away
DIRECTIONS = np.array([(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, -2, 2), (-2, 0.01, 1)], dtype=float)
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1)[:, None]


NEARER = (1.5, 2.5, 4.0, 6.9, 7.1, 12.0, 19.9, 20.1)
FARTHER = (50.0, 300.0, 1e4, 1e5)
BOXES = {"cube": (1.0, 1.0, 1.0), "brick": (1.0, 3.0, 0.5), "bar": (30.0, 1.0, 1.0)}
FAR_CENTER = np.array((0.3, -0.2, 0.9))


def far_points(box, multiples):
    return (FAR_CENTER + max(BOXES[box]) * np.outer(multiples, DIRECTIONS.ravel()).reshape(-1, 3)).copy()


@cache
def far_integrals(box, *, gradient):
    """Faces near, where they lose r/h of their digits; Gauss points far away, where five per edge are exact."""
    faces = cuboid_quadrature.gradient_moments if gradient else cuboid_quadrature.moments
    near = faces(far_points(box, NEARER), FAR_CENTER, BOXES[box])
    rule = volume_quadrature.cuboid_nodes(FAR_CENTER, BOXES[box], 4)
    far = volume_quadrature.volume_moments(far_points(box, FARTHER), rule, gradient=gradient)
    return np.concatenate([near, far], axis=1)


@pytest.mark.parametrize("nu", [0.3, pytest.param(0.5, marks=pytest.mark.slow)])
@pytest.mark.parametrize("box", ["bar", *(pytest.param(box, marks=pytest.mark.slow) for box in ("cube", "brick"))])
def test_far_field_of_cuboids(box, nu):
    """From beside the cuboid to 1e5 edges, across every change of method."""
    shape = eigencontact.make("cuboid", center=tuple(FAR_CENTER), edges=BOXES[box])
    points = far_points(box, NEARER + FARTHER)
    assert (points[:, 2] >= 0).all()
    integrals = far_integrals(box, gradient=False)
    expected = np.array([mindlin.displacement(integrals, e, nu) for e in UNITS])
    assert worst(fields(shape, points, nu, "displacement"), expected) <= 1e-10
    integrals = far_integrals(box, gradient=True)
    expected = np.array([mindlin.stress(integrals, e, nu, np.zeros(len(points))) for e in UNITS])
    assert worst(fields(shape, points, nu, "stress"), expected) <= 1e-10


@pytest.mark.slow
def test_cuboids_at_random():
    """Edges over four decades, flush or not, points in and around them and up to 1000 lengths away."""
    rng = np.random.default_rng(11)
    for trial in range(40):
        nu = POISSON[trial % len(POISSON)]
        edges = 10 ** rng.uniform(-2, 2, 3)
        top = 0.0 if trial % 3 == 0 else 10 ** rng.uniform(-4, 2)
        center = np.array([*rng.uniform(-1, 1, 2), edges[2] / 2 + top])
        around = center + edges / 2 * rng.uniform(-1.5, 1.5, (3, 3))
        points = np.vstack([around, center + 10 ** rng.uniform(-2, 3) * rng.normal(size=3)])
        points[:, 2] = np.abs(points[:, 2])
        points[0, 2] = 0.0
        shape = eigencontact.make("cuboid", center=tuple(center), edges=tuple(edges))
        integrals = cuboid_quadrature.moments(points, center, edges)
        expected = np.array([mindlin.displacement(integrals, e, nu) for e in UNITS])
        assert worst(fields(shape, points, nu, "displacement"), expected) <= 2e-10
        integrals = cuboid_quadrature.gradient_moments(points, center, edges)
        share = cuboid_quadrature.inside(points, center, edges)
        expected = np.array([mindlin.stress(integrals, e, nu, share) for e in UNITS])
        assert worst(fields(shape, points, nu, "stress"), expected) <= 2e-10


# ------------------------------------------------------------------------------------------- balls and ellipsoids
TURN = np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3
ROUND = {
    "ball": ((0.2, -0.1, 1.4), (0.7, 0.7, 0.7), None),
    "prolate": ((0.2, -0.1, 1.4), (1.0, 0.6, 0.6), None),
    "oblate": ((0.2, -0.1, 1.4), (0.9, 0.9, 0.5), None),
    "triaxial": ((0.2, -0.1, 1.4), (1.0, 0.8, 0.55), None),
    "turned": ((0.2, -0.1, 1.4), (1.0, 0.8, 0.55), TURN),
}
every_round_shape = with_every_nu(ROUND, (), slow=("prolate", "triaxial"))
ROUND_POINTS = [
    (0.2, -0.1, 1.4), (0.3, 0.05, 1.3), (0.2, -0.1, 1.6), (2.0, 0.7, 1.8), (0.2, -0.1, 3.5), (2.2, -0.1, 1.4),
    (1.5, -2.0, 0.0), (0.2, 2.5, 0.0), (5.0, 4.0, 9.0),
]  # fmt: skip
ROUND_INSIDE = np.array([1, 1, 1, 0, 0, 0, 0, 0, 0], dtype=float)


def round_shape(name):
    center, semi_axes, rotation = ROUND[name]
    if name == "ball":
        return eigencontact.make("sphere", center=center, radius=semi_axes[0])
    return eigencontact.make("ellipsoid", center=center, semi_axes=semi_axes, rotation=rotation)


@cache
def round_integrals(name, space, *, gradient):
    rule = volume_quadrature.ellipsoid_boundary(*ROUND[name], 44)
    return volume_quadrature.boundary_moments(ROUND_POINTS, rule, space, gradient=gradient)


@pytest.mark.parametrize("space", ["half", "full"])
@every_round_shape
def test_round_shapes(name, nu, space):
    shape, share = round_shape(name), ROUND_INSIDE
    integrals = round_integrals(name, space, gradient=False)
    expected = np.array([mindlin.displacement(integrals, e, nu) for e in UNITS])
    assert worst_of_all(fields(shape, ROUND_POINTS, nu, "displacement", space), expected) <= 1e-11
    integrals = round_integrals(name, space, gradient=True)
    expected = np.array([mindlin.strain(integrals, e, nu) for e in UNITS])
    assert worst(fields(shape, ROUND_POINTS, nu, "strain", space), expected) <= 1e-10
    expected = np.array([mindlin.stress(integrals, e, nu, share) for e in UNITS])
    assert worst(fields(shape, ROUND_POINTS, nu, "stress", space), expected) <= 1e-10


@with_every_nu(["turned", "oblate", "ball"], (), slow=("ball",))
def test_far_field_of_round_shapes(name, nu):
    """From 8 to 1e5 semi-axes."""
    center, semi_axes, rotation = ROUND[name]
    points = (np.array(center) + np.outer((8.0, 200.0, 1e5), DIRECTIONS.ravel()).reshape(-1, 3)).copy()
    points = points[points[:, 2] >= 0]
    rule = volume_quadrature.ellipsoid_nodes(center, semi_axes, rotation, 7)
    integrals = volume_quadrature.volume_moments(points, rule)
    expected = np.array([mindlin.displacement(integrals, e, nu) for e in UNITS])
    assert worst(fields(round_shape(name), points, nu, "displacement"), expected) <= 1e-10


@every_nu
@pytest.mark.parametrize("aspect", [1.0, 1.2, 30.0, 0.03])
def test_eshelby_tensors(aspect, nu):
    """ES-1, and spheroids about x."""
    if aspect == 1:
        shape = eigencontact.make("sphere", center=(1, 2, 3), radius=2)
        tensor = eshelby.sphere_tensor(nu)
    else:
        shape = eigencontact.make("ellipsoid", center=(1, 2, 3), semi_axes=(2 * aspect, 2, 2))
        tensor = eshelby.spheroid_tensor(aspect, nu)
    found = fields(shape, [(1, 2, 3), (1 + aspect, 2.5, 2.5)], nu, "strain", "full")
    expected = np.array([[eshelby.apply(tensor, e)] * 2 for e in UNITS])
    np.testing.assert_allclose(found, expected, atol=2e-12)


@every_nu
@pytest.mark.parametrize("depth", [1.0, 1.5, 3.0])
def test_dilatational_ball(depth, nu):
    """DL-1: Mindlin and Cheng's ball, tangent to the surface and below it."""
    ball = eigencontact.make("sphere", center=(0, 0, depth), radius=1)
    z = np.concatenate([np.linspace(1e-3, depth + 0.99, 9), depth + np.array([1.01, 2.0, 40.0])])
    points = np.concatenate(
        [np.stack([0 * z, 0 * z, z], axis=1), np.stack([1.3 + z, 0.4 * z, z], axis=1), [(0.3, 0.4, 0), (9, 0, 0)]]
    )
    expected = eshelby.dilatational_ball_displacement(points, (0, 0, depth), 1.0, 1.0, nu)
    assert worst_of_all(field(ball, np.eye(3), points, nu), expected) <= 1e-13
    expected = eshelby.dilatational_ball_stress(points, (0, 0, depth), 1.0, 1.0, nu)
    assert worst_of_all(field(ball, np.eye(3), points, nu, "stress"), expected) <= 1e-13


@pytest.mark.parametrize(("depth", "expected"), [(1.5, 0.7337), (2.0, 0.3095), (3.0, 0.0917)])
def test_surface_above_a_dilatational_ball(depth, expected):
    """DL-1: surface tension and uplift, in units of E e."""
    ball = eigencontact.make("sphere", center=(0, 0, depth), radius=1)
    tension, uplift = eshelby.dilatational_ball_surface(depth, 1.0, 1.0, 0.3, 2.6)
    stress = field(ball, np.eye(3), [(0, 0, 0)], 0.3, "stress")[0]
    assert stress[0, 0] == close(tension, rel=1e-13)
    assert stress[0, 0] / 2.6 == close(expected, abs=5e-5)
    assert -field(ball, np.eye(3), [(0, 0, 0)], 0.3)[0, 2] == close(uplift, rel=1e-13)


def test_ball_tangent_to_the_surface_on_its_axis():
    """DL-1, c = a: just below the touching point, and Mindlin and Cheng's axis; units E e or 2 mu e (1+nu)/(1-nu)."""
    ball = eigencontact.make("sphere", center=(0, 0, 1), radius=1)
    just_below, beside = field(ball, np.eye(3), [(0, 0, 1e-9), (1e-6, 0, 0)], 0.3, "stress") / 2.6
    assert just_below[0, 0] == close(1.048, abs=5e-4)
    assert beside[0, 0] == close(2.476, abs=5e-4)
    assert beside[0, 0] - just_below[0, 0] == close(1 / 0.7, abs=1e-5)
    as_ellipsoid = eigencontact.make("ellipsoid", center=(0, 0, 1), semi_axes=(1, 1, 1))
    touching = [field(shape, np.eye(3), [(0, 0, 0)], 0.3, "stress")[0, 0, 0] / 2.6 for shape in (ball, as_ellipsoid)]
    assert touching == close([beside[0, 0]] * 2, abs=1e-5)
    depth, sigma_xx, sigma_zz = np.array(eshelby.TANGENT_BALL_AXIS[1:]).T
    depth[depth == 2.0] -= 1e-9
    points = np.stack([0 * depth, 0 * depth, depth], axis=1)
    stress = field(ball, np.eye(3), points, 0.3, "stress") / (2 * 1.3 / 0.7)
    np.testing.assert_allclose(stress[:, 0, 0], sigma_xx, atol=1e-6)
    np.testing.assert_allclose(stress[:, 2, 2], sigma_zz, atol=1e-6)


@pytest.mark.parametrize("semi_axes", [(1.0, 1.0, 1.0), (3.0, 3.0, 1.0), (7.0, 7.0, 1.0)])
@pytest.mark.parametrize("depth", [1.0, 2.0])
def test_what_jumps_at_the_interface(semi_axes, depth):
    """DL-3: sigma_zz continuous along the normal, sigma_xx along the transverse line; the interior is not uniform."""
    body = eigencontact.make("ellipsoid", center=(0, 0, depth), semi_axes=semi_axes)
    h, a = 1e-9, semi_axes[0]
    points = [(0, 0, depth + 1 - h), (0, 0, depth + 1 + h), (a - h * a, 0, depth), (a + h * a, 0, depth)]
    pole_in, pole_out, side_in, side_out = field(body, np.eye(3), points, 0.3, "stress") / 2.6
    assert pole_in[2, 2] == close(pole_out[2, 2], abs=1e-7)
    assert pole_out[0, 0] - pole_in[0, 0] == close(1 / 0.7, abs=1e-6)
    assert side_in[0, 0] == close(side_out[0, 0], abs=1e-5)
    assert side_out[2, 2] - side_in[2, 2] == close(1 / 0.7, abs=1e-4)
    inside = field(body, np.eye(3), [(0, 0, depth - 0.9), (0, 0, depth + 0.9)], 0.3, "stress") / 2.6
    assert abs(inside[0, 0, 0] - inside[1, 0, 0]) > 0.02


def test_flat_ellipsoids_near_the_surface_pull_it_less():
    """DL-3: sigma_xx at the surface above ellipsoids a : a : 1 that touch it falls with a; not above deeper ones."""
    tension = {}
    for depth in (1.001, 2.0):
        for a in (1.0, 3.0, 7.0):
            body = eigencontact.make("ellipsoid", center=(0, 0, depth), semi_axes=(a, a, 1.0))
            tension[a, depth] = field(body, np.eye(3), [(0, 0, 0)], 0.3, "stress")[0, 0, 0] / 2.6
    assert tension[1, 1.001] > tension[3, 1.001] > tension[7, 1.001] > 0
    assert min(tension[3, 2.0], tension[7, 2.0]) > tension[1, 2.0] > 0


@pytest.mark.parametrize("kind", ["cuboid", "ellipsoid"])
def test_long_bar(kind):
    """PB-1: an infinite stiff bar in a soft matrix, by its equivalent eigenstrain in a bar of aspect 40; full space."""
    bar = eshelby.infinite_bar(0.01, (210e9, 0.3), (50e9, 0.3))
    if kind == "cuboid":
        shape = eigencontact.make("cuboid", center=(0, 0, 5), edges=(40, 1, 1))
    else:
        shape = eigencontact.make("ellipsoid", center=(0, 0, 5), semi_axes=(20, 0.5, 0.5))
    stress = eigencontact.inclusion_field(
        shape,
        bar.equivalent,
        [(0, 0, 5)],
        young_modulus=50e9,
        poisson_ratio=0.3,
        quantity="stress",
        space="full",
    )[0]
    assert stress[0, 0] == close(-2163e6, rel=0.03)
    assert stress[1, 1] == close(-105.4e6, rel=0.03)
    assert stress[2, 2] == close(stress[1, 1], rel=1e-9)
    assert abs(stress[0, 0] - stress[1, 1]) == close(2058e6, rel=0.03)


# ------------------------------------------------------------------------------------------------- free surface
SHAPES = {name: cuboid(name) for name in CUBOIDS} | {name: round_shape(name) for name in ROUND}
SHAPES |= {
    "tangent ball": eigencontact.make("sphere", center=(0, 0, 1), radius=1),
    "tangent ellipsoid": eigencontact.make("ellipsoid", center=(0, 0, 0.5), semi_axes=(1.5, 1, 0.5)),
}


@with_every_nu(SHAPES, ("flush", "tangent ball"), slow=("deep", "1000 tall", "prolate", "triaxial"))
def test_the_surface_is_free(name, nu):
    """Traction on z = 0, relative to the largest stress of the same eigenstrain on the surface and in the shape.

    In a plate the stress of most eigenstrains lives near its rim, where a point is taken too.
    """
    shape = SHAPES[name]
    low, high = np.array(shape.bounds)
    rng = np.random.default_rng(3)
    spread = np.where(np.arange(60) % 2, 1.0, 4.0)[:, None] * (high - low)[:2] / 2
    surface = np.zeros((60, 3))
    surface[:, :2] = (low + high)[:2] / 2 + spread * rng.uniform(-1, 1, (60, 2))
    rim = high - 0.1 * (high - low).min()
    points = np.vstack([surface, [(low + high) / 2, rim]])
    stress = fields(shape, points, nu, "stress")
    traction = np.abs(stress[:, :60, :, 2]).max(axis=(1, 2))
    assert (traction <= 1e-12 * np.abs(stress).max(axis=(1, 2, 3))).all()


@pytest.mark.parametrize(("name", "space"), [*((name, "half") for name in SHAPES), ("flush", "full"), ("ball", "full")])
def test_fields_of_unit_eigenstrains_add_up_to_that_of_the_call(name, space):
    low, high = np.array(SHAPES[name].bounds)
    points = (low + high) / 2 + (high - low) / 2 * np.array([(0.2, 0.3, 0.1), (1.0, 0.2, 0.3), (3.0, 2.0, 0.9)])
    factors = np.array([1.0, -0.5, 0.7, 0.3, -0.9, 0.4])
    for quantity in ("displacement", "strain", "stress"):
        parts = fields(SHAPES[name], points, 0.3, quantity, space)
        whole = field(SHAPES[name], np.tensordot(factors, UNITS, axes=1), points, 0.3, quantity, space)
        assert np.abs(whole - np.tensordot(factors, parts, axes=1)).max() <= 1e-12 * np.abs(parts).max()


# --------------------------------------------------------------------------------------- what holds for every field
coordinate = st.floats(-3, 3)
depths = st.floats(0, 5)
strains = st.lists(st.floats(-1, 1), min_size=6, max_size=6).filter(lambda e: max(map(abs, e)) > 1e-3)
ratios = st.sampled_from(POISSON)
names = st.sampled_from(["flush", "shallow", "turned", "ball"])
quick = settings(max_examples=10, deadline=None)


def tensor(six):
    return np.einsum("a,aij->ij", six, np.array(UNITS))


def away_from_edges(shape, point):
    """Where a log is not yet large: strain near the edges of a cuboid means little."""
    low, high = np.array(shape.bounds)
    gap = np.minimum(np.abs(point - low), np.abs(point - high))
    return (gap > 1e-3).sum() >= 2


@quick
@given(name=names, one=strains, two=strains, factor=st.floats(-2, 2), x=coordinate, y=coordinate, z=depths, nu=ratios)
def test_superposition_of_eigenstrains(name, one, two, factor, x, y, z, nu):
    shape, point = SHAPES[name], [(x, y, z)]
    if not away_from_edges(shape, np.array(point[0])):
        return
    for quantity in ("displacement", "stress"):
        parts = [field(shape, tensor(e), point, nu, quantity) for e in (one, two)]
        whole = field(shape, tensor(one) + factor * tensor(two), point, nu, quantity)
        size = max(np.abs(field(shape, e, point, nu, quantity)).max() for e in UNITS)
        np.testing.assert_allclose(whole, parts[0] + factor * parts[1], atol=1e-12 * size)


@quick
@given(e=strains, cut=st.floats(0.1, 0.9), axis=st.integers(0, 2), x=coordinate, y=coordinate, z=depths, nu=ratios)
def test_superposition_of_parts(e, cut, axis, x, y, z, nu):
    """Two halves of a cuboid give what the whole gives."""
    center, edges = (np.array(v) for v in CUBOIDS["shallow"])
    point = [(x, y, z)]
    total = 0.0
    for start, stop in ((0.0, cut), (cut, 1.0)):
        part_center, part_edges = center.copy(), edges.copy()
        part_center[axis] += edges[axis] * ((start + stop) / 2 - 0.5)
        part_edges[axis] *= stop - start
        part = eigencontact.make("cuboid", center=tuple(part_center), edges=tuple(part_edges))
        total = total + field(part, tensor(e), point, nu)
    whole = field(cuboid("shallow"), tensor(e), point, nu)
    np.testing.assert_allclose(total, whole, atol=1e-12)


MIRROR = np.diag([-1.0, 1.0, 1.0])
QUARTER = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


@quick
@pytest.mark.parametrize("matrix", [MIRROR, QUARTER], ids=["mirror", "quarter turn"])
@given(e=strains, x=coordinate, y=coordinate, z=depths, nu=ratios)
def test_mirror_and_quarter_turn(matrix, e, x, y, z, nu):
    """A turned cuboid with a turned eigenstrain has the turned field."""
    center, edges = (np.array(v) for v in CUBOIDS["shallow"])
    turned = eigencontact.make("cuboid", center=tuple(matrix @ center), edges=tuple(np.abs(matrix @ edges)))
    point, shape = np.array((x, y, z)), cuboid("shallow")
    if not away_from_edges(shape, point):
        return
    strain = tensor(e)
    turned_strain = matrix @ strain @ matrix.T
    u, turned_u = field(shape, strain, [point], nu)[0], field(turned, turned_strain, [matrix @ point], nu)[0]
    np.testing.assert_allclose(turned_u, matrix @ u, atol=1e-13)
    stress = field(shape, strain, [point], nu, "stress")[0]
    turned_stress = field(turned, turned_strain, [matrix @ point], nu, "stress")[0]
    size = max(np.abs(field(shape, unit_strain, [point], nu, "stress")).max() for unit_strain in UNITS)
    np.testing.assert_allclose(turned_stress, matrix @ stress @ matrix.T, atol=1e-11 * size)


@quick
@given(one=strains, two=strains, nu=ratios, gap=st.floats(1.0, 6.0), space=st.sampled_from(["half", "full"]))
def test_reciprocity(one, two, nu, gap, space):
    """Each inclusion does the same work on the other: the integrals of sigma : e* over the partner are equal."""
    brick = eigencontact.make("cuboid", center=(0.1, 0.2, 0.6), edges=(1.0, 1.4, 1.0))
    ball_center = (0.6 + gap, -0.5, 1.3)
    ball = eigencontact.make("sphere", center=ball_center, radius=0.5)
    work = []
    for source, e, rule, other in (
        (brick, one, volume_quadrature.ball_nodes(ball_center, 0.5, 12), two),
        (ball, two, volume_quadrature.cuboid_nodes((0.1, 0.2, 0.6), (1.0, 1.4, 1.0), 14), one),
    ):
        positions, weights = rule
        stress = field(source, tensor(e), positions, nu, "stress", space)
        work.append(np.einsum("m,mij,ij->", weights, stress, tensor(other)))
    assert work[0] == close(work[1], abs=1e-9)


@pytest.mark.parametrize("scale", [1e-9, 1e3])
@pytest.mark.parametrize("name", ["flush", "turned", "ball"])
def test_units(name, scale):
    """The same bodies in nanometres and kilometres; exactly flush bodies stay flush."""
    points = places(name, singular=False) if name in CUBOIDS else np.array(ROUND_POINTS)
    if name in CUBOIDS:
        center, edges = (tuple(scale * v for v in values) for values in CUBOIDS[name])
        scaled = eigencontact.make("cuboid", center=center, edges=edges)
    elif name == "ball":
        center, semi_axes, _ = ROUND[name]
        scaled = eigencontact.make("sphere", center=tuple(scale * c for c in center), radius=scale * semi_axes[0])
    else:
        center, semi_axes, rotation = ROUND[name]
        center, semi_axes = (tuple(scale * v for v in values) for values in (center, semi_axes))
        scaled = eigencontact.make("ellipsoid", center=center, semi_axes=semi_axes, rotation=rotation)
    for quantity, power in (("displacement", 1), ("strain", 0), ("stress", 0)):
        found = fields(scaled, scale * points, 0.3, quantity) / scale**power
        assert worst_of_all(found, fields(SHAPES[name], points, 0.3, quantity)) <= 1e-11
