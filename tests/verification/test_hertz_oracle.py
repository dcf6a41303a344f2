"""Each closed form against quadrature of a point-load solution, a limit, or a catalogued number."""

import numpy as np
import pytest
from scipy.integrate import dblquad, quad

from close import close
from eigencontact_verification.oracles import hertz

STEEL = 210e9 / (1 - 0.3**2)
E_STAR = 3.0


@pytest.mark.parametrize(
    ("radius", "load", "expected", "digits"),
    [
        (105e-6, 0.65, (6.0533e-6, 8469.6e6, 348.98e-9), (0.5e-10, 0.5e5, 0.5e-11)),
        (200e-6, 12.307, (20.000e-6, 14.691e9, 2.000e-6), (0.5e-9, 0.5e6, 0.5e-9)),
    ],
    ids=["HZ-1", "HZ-2"],
)
def test_sphere_gives_the_catalogue_to_its_last_digit(radius, load, expected, digits):
    found = hertz.hertz_sphere(load, radius, STEEL)
    assert all(abs(f - e) <= d for f, e, d in zip(found, expected, digits, strict=True))


def test_max_von_mises_gives_hz3():
    value, depth = hertz.max_von_mises(0.3)
    assert value == close(0.62004, abs=5e-6)
    assert depth == close(0.4809, abs=5e-5)
    assert 0.5 * value == close(0.3100, abs=5e-5)
    assert 1.0 / value == close(1.6128, abs=5e-5)


@pytest.mark.parametrize("ratio", [1e-6, 1e-4, 0.01, 0.3, 0.999, 1.0, 1.0 + 1e-9, 1.5, 20.0, 1e4, 1e6])
def test_ellipse_fits_the_paraboloid_by_quadrature(ratio):
    """The potential of the semi-ellipsoid, integrated numerically, equals approach - separation on both axes.

    u_z(x, y) = p0 a b / (2 E*) ∫_0^∞ (1 - x²/(a²+w) - y²/(b²+w)) dw / √((a²+w)(b²+w) w), with w = e^(2s).
    """
    load, rx, ry = 0.7, 5.0 * ratio, 5.0
    a, b, p0, approach = hertz.hertz_ellipse(load, rx, ry, E_STAR)
    low, high = np.log(min(a, b)) - 40, np.log(max(a, b)) + 40
    s = np.linspace(low, high, 40001)  # trapezoid: the integrand decays exponentially at both ends
    w = np.exp(2 * s)
    common = p0 * a * b / (2 * E_STAR) * 2 * np.sqrt(w) / np.sqrt((a * a + w) * (b * b + w)) * (s[1] - s[0])
    assert np.sum(common) == close(approach, rel=1e-11)
    assert np.sum(common / (a * a + w)) == close(0.5 / rx, rel=1e-11)
    assert np.sum(common / (b * b + w)) == close(0.5 / ry, rel=1e-11)
    assert 2 / 3 * np.pi * a * b * p0 == close(load, rel=1e-14)


def test_potential_of_the_semi_ellipsoid_is_the_displacement_under_the_pressure():
    """Direct quadrature of Boussinesq's point load, in polar coordinates about the field point, at three points."""
    rx, ry, load = 7.0, 2.0, 0.4
    a, b, p0, approach = hertz.hertz_ellipse(load, rx, ry, E_STAR)
    for x, y in [(0.0, 0.0), (0.5 * a, 0.2 * b), (-0.3 * a, 0.7 * b)]:

        def along_ray(angle, x=x, y=y):  # ∫ √(c - 2 h t - q t²) dt over the chord from t = 0, in closed form
            cos, sin = np.cos(angle) / a, np.sin(angle) / b
            q, h, c = cos**2 + sin**2, x / a * cos + y / b * sin, 1 - (x / a) ** 2 - (y / b) ** 2
            top = (h * h + q * c) / q  # c - 2ht - qt² = top - q (t + h/q)²
            start = h / q * np.sqrt(q / top)
            return top / np.sqrt(q) * 0.5 * (np.pi / 2 - np.arcsin(start) - start * np.sqrt(1 - start**2))

        displacement = p0 / (np.pi * E_STAR) * quad(along_ray, 0, 2 * np.pi, epsabs=0, epsrel=1e-12)[0]
        assert displacement == close(approach - x * x / (2 * rx) - y * y / (2 * ry), rel=1e-11)


def test_ellipse_of_equal_radii_is_the_sphere():
    a, p0, approach = hertz.hertz_sphere(0.7, 5.0, E_STAR)
    assert hertz.hertz_ellipse(0.7, 5.0, 5.0, E_STAR) == close((a, a, p0, approach), rel=1e-13)


def test_ellipse_of_exchanged_radii_is_turned():
    a, b, p0, approach = hertz.hertz_ellipse(0.7, 5.0, 0.3, E_STAR)
    assert hertz.hertz_ellipse(0.7, 0.3, 5.0, E_STAR) == close((b, a, p0, approach), rel=1e-13)


@pytest.mark.parametrize("ratio", [1e3, 1e6])
def test_slender_ellipse_tends_to_the_line_contact(ratio):
    """At the middle of a slender contact b = √(4 P' R / (π E*)) with the local line load P' = π p0 b / 2."""
    _, b, p0, _ = hertz.hertz_ellipse(0.7, ratio, 1.0, E_STAR)
    assert b == close(2 * p0 / E_STAR, rel=3 / ratio**0.9)


def test_pressure_integrates_to_the_load_and_ends_at_the_ellipse():
    a, b, p0, _ = hertz.hertz_ellipse(0.7, 5.0, 2.0, E_STAR)
    value, _ = dblquad(
        lambda t, r: a * b * r * float(hertz.pressure(a * r * np.cos(t), b * r * np.sin(t), a, b, p0)),
        0,
        1,
        0,
        2 * np.pi,
    )
    assert value == close(0.7, rel=1e-7)
    assert hertz.pressure([1.01 * a, 0.0], [0.0, -1.01 * b], a, b, p0).tolist() == [0.0, 0.0]


def ring(z, stress):
    """Sum of the stress of point loads √(1 - r²) over the disk, at depth z on the axis."""
    return quad(lambda r: 2 * np.pi * r * np.sqrt(1 - r * r) * stress(r, np.hypot(r, z)), 0, 1, epsrel=1e-12)[0]


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("z", [0.05, 0.48, 1.0, 4.0])
def test_axis_stress_by_quadrature_of_boussinesq(z, nu):
    """Point load: σ_z = -3 z³/(2π R⁵) and trace -(1+ν) z/(π R³)."""
    normal = ring(z, lambda _, R: -3 * z**3 / (2 * np.pi * R**5))
    trace = ring(z, lambda _, R: -(1 + nu) * z / (np.pi * R**3))
    sigma_z, sigma_r = hertz.axis_stress(z, nu)
    assert float(sigma_z) == close(normal, abs=5e-11)
    assert float(sigma_r) == close(0.5 * (trace - normal), abs=5e-11)


@pytest.mark.parametrize("z", [0.05, 0.48, 1.0, 4.0])
def test_axis_shear_by_quadrature_of_cerruti(z):
    """Point force along x: τ_xz = -3 x² z/(2π R⁵); the mean of x² over a ring is r²/2."""
    expected = ring(z, lambda r, R: -3 * r * r * z / (4 * np.pi * R**5))
    assert float(hertz.axis_shear_sliding(z)) == close(expected, abs=5e-11)


def test_axis_shear_gives_hm2():
    expected = [-0.60721, -0.26964, -0.07190]
    assert hertz.axis_shear_sliding([0.2, 0.5, 1.0]) == close(expected, abs=5e-6)


@pytest.mark.parametrize(
    ("friction", "tension", "von_mises"), [(0, 0.1333, 0.2), (0.25, 0.5555, 0.4770), (0.5, 0.9776, 0.8888)]
)
def test_sliding_surface_gives_hm1_and_hm5(friction, tension, von_mises):
    assert hertz.trailing_edge_tension(friction, 0.3) == close(tension, abs=5e-5)
    assert hertz.surface_von_mises_sliding(friction, 0.3) == close(von_mises, abs=5e-5)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_trailing_edge_tension_by_quadrature_of_cerruti(nu):
    """Point force along x on the surface: σ_xx = -[3ν x³/r⁵ + (1-2ν) x/r³]/π, seen from the edge of the disk.

    In polar coordinates (ρ, φ) about the edge 1 - r² = ρ (2 cos φ - ρ), and ρ = 2 cos φ sin²(t).
    """
    value, _ = dblquad(
        lambda t, phi: (
            (3 * nu * np.cos(phi) ** 3 + (1 - 2 * nu) * np.cos(phi)) / np.pi * 4 * np.cos(phi) * np.cos(t) ** 2
        ),
        -np.pi / 2,
        np.pi / 2,
        0,
        np.pi / 2,
    )
    pressure_alone = float(hertz.surface_stress(1.0, nu)[0])
    assert hertz.trailing_edge_tension(0.4, nu) == close(pressure_alone + 0.4 * value, abs=1e-9)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("r", [0.01, 0.4, 0.9, 1.3, 5.0])
def test_surface_stress_by_hookes_law_and_the_radial_displacement(r, nu):
    """E u_r = -(1-2ν)(1+ν) (1/r) ∫_0^r p s ds for any pressure of revolution; strains of it by quadrature."""
    moment = quad(lambda s: s * np.sqrt(1 - s * s), 0, min(r, 1.0), epsabs=0, epsrel=1e-13)[0]
    hoop = -(1 - 2 * nu) * (1 + nu) * moment / r**2
    radial = -hoop - (1 - 2 * nu) * (1 + nu) * np.sqrt(max(0.0, 1 - r * r))
    sigma_r, sigma_t, sigma_z = (float(s) for s in hertz.surface_stress(r, nu))
    assert sigma_t - nu * (sigma_r + sigma_z) == close(hoop, abs=1e-12)
    assert sigma_r - nu * (sigma_t + sigma_z) == close(radial, abs=1e-12)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_surface_and_axis_stress_agree_at_the_origin(nu):
    sigma_r, sigma_t, sigma_z = (float(s) for s in hertz.surface_stress(0.0, nu))
    axis_z, axis_r = (float(s) for s in hertz.axis_stress(0.0, nu))
    assert (sigma_r, sigma_t, sigma_z) == close((axis_r, axis_r, axis_z), abs=1e-15)
    assert hertz.surface_von_mises_sliding(0.0, nu) == close(abs(axis_z - axis_r), abs=1e-15)


def test_love_centre_by_quadrature_and_for_the_square():
    square = hertz.love_centre_displacement(2.0, 0.5, 0.5, 7.0, 0.3)
    assert square == close(8 * np.arcsinh(1.0) * (1 - 0.09) * 2.0 * 0.5 / (np.pi * 7.0), rel=1e-15)
    # polar coordinates: ∫∫ dA/r over the rectangle is ∫ (distance to the boundary) dφ
    a, b = 0.5, 0.02
    corner = np.arctan2(b, a)
    rays = 4 * (quad(lambda t: a / np.cos(t), 0, corner)[0] + quad(lambda t: b / np.sin(t), corner, np.pi / 2)[0])
    expected = (1 - 0.09) * 2.0 / (np.pi * 7.0) * rays
    assert hertz.love_centre_displacement(2.0, a, b, 7.0, 0.3) == close(expected, rel=1e-12)
