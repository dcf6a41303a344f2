"""The oracle of polynomial eigenstrain against closed forms of thermal strain and another quadrature."""

import numpy as np
import pytest

from close import close
from eigencontact_verification.oracles import mindlin
from eigencontact_verification.oracles.polynomial_eigenstrain import PolynomialEllipsoid
from eigencontact_verification.oracles.volume_quadrature import ellipsoid_nodes, volume_moments

CENTER = (0.1, -0.2, 1.7)
AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
TURN = np.linalg.qr(np.array([[1.0, 0.4, -0.2], [0.1, 1.0, 0.5], [0.3, -0.6, 1.0]]))[0]
POINTS = np.array([[0.2, 0.1, 0.3], [-0.3, 0.2, -0.4], [0.0, 0.0, 0.05], [1.6, 0.4, -0.2], [0.4, -1.5, 1.2]])


def ball(*terms, count=18, radius=1.0):
    return PolynomialEllipsoid(center=CENTER, semi_axes=(radius,) * 3, terms=terms, count=count)


@pytest.mark.parametrize("nu", [0.0, 0.3])
@pytest.mark.parametrize("radius", [1.0, 0.5])
def test_thermal_strain_that_grows_with_the_square_of_the_radius(nu, radius):
    """u = (1+nu)/(1-nu) r^-2 times the integral of e r², full space; so does the radial stress."""
    heated = ball(*(((2 * x, 2 * y, 2 * z), np.eye(3)) for x, y, z in AXES), radius=radius)
    offset = radius * POINTS
    r = np.linalg.norm(offset, axis=1, keepdims=True) / radius
    share = np.where(r < 1, r**2, r**-3) / 5
    displacement = (1 + nu) / (1 - nu) * share * offset
    at = offset + CENTER
    assert heated.displacement(at, nu, "full") == close(displacement, abs=1e-7)
    normal = offset / radius / r
    radial = np.einsum("nij,ni,nj->n", heated.stress(at, nu, "full"), normal, normal)
    assert radial == close(-4 * (1 + nu) / (1 - nu) * share[:, 0], abs=1e-6)


@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_thermal_strain_that_grows_along_z(nu):
    """Goodier's potential: the displacement is the gradient of (1+nu)/(1-nu) z (r²/10 - 1/6), or of -z/(15 r³)."""
    heated = ball(((0, 0, 1), np.eye(3)))
    r = np.linalg.norm(POINTS, axis=1)[:, None]
    z, up = POINTS[:, 2:], np.array([[0.0, 0.0, 1.0]])
    inside = up * (r**2 / 10 - 1 / 6) + z * POINTS / 5
    outside = -up / (15 * r**3) + z * POINTS / (5 * r**5)
    expected = (1 + nu) / (1 - nu) * np.where(r < 1, inside, outside)
    assert heated.displacement(POINTS + CENTER, nu, "full") == close(expected, abs=1e-7)


@pytest.mark.parametrize("space", ["full", pytest.param("half", marks=pytest.mark.slow)])
def test_outside_it_is_the_integral_of_the_dipoles(space):
    """The same by derivatives of Green's function with respect to the source, no parts integrated."""
    tensor = np.array([[1.0, 0.2, -0.5], [0.2, -0.7, 0.4], [-0.5, 0.4, 0.3]])
    region = {"center": CENTER, "semi_axes": (0.5, 0.35, 0.3), "rotation": TURN, "count": 10}
    oracle = PolynomialEllipsoid(**region, terms=[((1, 0, 2), tensor), ((0, 0, 0), 0.3 * tensor)])
    positions, weights = ellipsoid_nodes(*(region[name] for name in ("center", "semi_axes", "rotation", "count")))
    density = oracle.density((1, 0, 2), positions) + 0.3
    points = np.array([[0.5, 0.3, 0.0]])
    moments = volume_moments(points, (positions, weights * density), space)
    assert oracle.displacement(points, 0.3, space) == close(mindlin.displacement(moments, tensor, 0.3), abs=1e-8)
    moments = volume_moments(points, (positions, weights * density), space, gradient=True)
    assert oracle.stress(points, 0.3, space) == close(mindlin.stress(moments, tensor, 0.3, [0]), abs=1e-7)


def test_surface_is_free():
    oracle = ball(((0, 1, 1), np.diag([1.0, 2.0, -1.0])), ((0, 0, 3), np.ones((3, 3))))
    stress = oracle.stress([[0.0, 0.0, 0.0], [1.0, 0.5, 0.0]], 0.4)
    assert np.abs(stress[:, 2]).max() < 1e-12
    assert np.abs(stress).max() > 0.1
