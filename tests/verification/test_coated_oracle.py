"""The oracle of coated contact against Hertz, the sliding closed forms, the table of cases and its own displacement."""

from functools import cache

import numpy as np
import pytest
from scipy.special import ellipkm1, j0

from close import close
from eigencontact_verification.oracles import hertz, sliding_stress
from eigencontact_verification.oracles.coated_contact import CoatedContact, coated_contact, contact_of_radius
from eigencontact_verification.oracles.coated_stress import sliding_stress as coated_sliding
from eigencontact_verification.oracles.sliding_stress import by_quadrature, von_mises

NU, RADIUS = 0.3, 10.0
MODULUS = 1.0 / (1.0 - NU**2)
LOAD = 4.0 / 3.0 * MODULUS / RADIUS  # contact radius 1 on the bare substrate
A0, P0, DELTA0 = hertz.hertz_sphere(LOAD, RADIUS, MODULUS)


@cache
def coated(ratio: float, thickness: float = 1.0) -> CoatedContact:
    return coated_contact(LOAD, RADIUS, [(thickness, ratio, NU)], (1.0, NU))


@pytest.mark.parametrize(
    "layers",
    [(), ((1.0, 1.0, NU),), ((0.2, 1.0, NU), (2.0, 1.0, NU), (0.4, 1.0, NU))],
    ids=["bare", "one layer", "three layers"],
)
def test_layers_of_the_substrate_are_hertz(layers):
    found = coated_contact(LOAD, RADIUS, layers, (1.0, NU))
    assert [found.radius, found.approach, found.max_pressure] == close([A0, DELTA0, P0], rel=1e-10)
    r = np.linspace(0.0, 1.2, 13)
    assert found.pressure(r) == close(hertz.pressure(r, 0.0, A0, A0, P0), abs=1e-10 * P0)


def test_two_equal_bodies_are_hertz_of_half_the_modulus():
    found = coated_contact(LOAD, RADIUS, [(1.0, 1.0, NU)], (1.0, NU), sphere_compliance=1.0 / MODULUS)
    a, p0, approach = hertz.hertz_sphere(LOAD, RADIUS, 0.5 * MODULUS)
    assert [found.radius, found.approach, found.max_pressure] == close([a, approach, p0], rel=1e-10)


@pytest.mark.parametrize(
    ("ratio", "pressure", "radius", "approach"), [(0.5, 0.7047, 1.2066, 1.2271), (2.0, 1.4754, 0.8185, 0.8269)]
)
def test_catalogue_of_a_coating_as_thick_as_the_contact(ratio, pressure, radius, approach):
    found = coated(ratio)
    values = [found.max_pressure / P0, found.radius / A0, found.approach / DELTA0]
    assert values == close([pressure, radius, approach], abs=5.1e-5)
    assert found.load == close(LOAD, rel=1e-12)


@pytest.mark.parametrize(
    ("size", "pressure", "area"), [(0.05, 0.957, 1.099), (0.2, 0.855, 1.261), (0.5, 0.721, 1.434), (1.5, 0.638, 1.568)]
)
def test_catalogue_of_soft_coatings_by_thickness(size, pressure, area):
    found = coated(0.5, size * np.sqrt(np.pi))
    assert [found.max_pressure / P0, found.radius**2] == close([pressure, area], abs=5.1e-4)


@pytest.mark.parametrize("ratio", [pytest.param(0.5, marks=pytest.mark.slow), 2.0])
def test_thick_coating_tends_to_hertz_of_the_coating(ratio):
    """What is left falls with the cube of h: the curvature that the substrate adds under the contact."""
    thick = np.array([8.0, 16.0, 32.0])
    errors = [abs(coated(ratio, h).max_pressure / P0 / ratio ** (2 / 3) - 1.0) for h in thick]
    slope = np.polyfit(np.log(thick), np.log(errors), 1)[0]
    assert abs(slope + 3.0) < 0.1
    assert errors[-1] < 1e-5


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.2, 5.0])
def test_displacement_under_the_sphere_is_the_sphere(ratio):
    """The pressure, put through the Green's function of the top layer and L(k), gives back δ - r²/2R."""
    found = coated(ratio)
    a, E = found.radius, found.modulus
    unit, weight = np.polynomial.legendre.leggauss(80)
    angle = 0.25 * np.pi * (unit + 1.0)
    s, w = a * np.sin(angle), 0.25 * np.pi * weight * a * np.cos(angle)
    spectrum = j0(np.multiply.outer(found.nodes, s)) @ (w * s * found.pressure(s))
    assert found.hankel(found.nodes) == close(spectrum, abs=1e-11 * LOAD)
    cubic, weight = 0.5 * (unit + 1.0), 0.5 * weight
    for r in (0.3 * a, 0.8 * a):
        # powers that take off the logarithm at s = r and the root at s = a
        middle = 0.5 * (r + a)
        pieces = [(r, -r, 3), (r, middle - r, 3), (a, middle - a, 2)]
        s = np.concatenate([start + length * cubic**power for start, length, power in pieces])
        w = np.concatenate([abs(length) * power * cubic ** (power - 1) * weight for _, length, power in pieces])
        rings = 4.0 / (np.pi * E) * s / (r + s) * ellipkm1(((r - s) / (r + s)) ** 2)
        top = float((w * rings) @ found.pressure(s))
        # `waves` holds 2/π L P and the weights
        rest = np.pi / E * float(j0(found.nodes * r) @ found.waves)
        assert top + rest == close(found.approach - r * r / (2.0 * RADIUS), rel=1e-8)


@pytest.mark.parametrize("z", [0.2, 1.7])
def test_sliding_stress_without_contrast(z):
    x, y = np.array([0.0, 0.3, -0.6, 1.2]), np.array([0.0, 0.1, 0.4, -0.3])
    found = coated_sliding(coated(1.0), x, y, z, friction=0.3) / P0
    wanted = np.array([by_quadrature((*point, z), 0.3, NU) for point in zip(x, y, strict=True)]).T
    assert found == close(wanted, abs=1e-10)
    assert found[:, 0] == close(sliding_stress.axis(z, 0.3, NU), abs=1e-10)


@pytest.mark.parametrize(
    ("ratio", "friction", "above", "below"), [(0.5, 0.0, -0.132, -0.069), (2.0, 0.25, 0.229, 0.008)]
)
def test_catalogue_of_the_interface(ratio, friction, above, below):
    """σ_xx jumps on the axis, and the tractions do not."""
    contact = coated(ratio)
    upper, lower = (
        coated_sliding(contact, [0.0, 0.4], [0.0, 0.3], 1.0, friction=friction, side=side) / P0
        for side in ("above", "below")
    )
    assert [upper[0, 0], lower[0, 0]] == close([above, below], abs=5.1e-4)
    assert upper[2:5] == close(lower[2:5], abs=1e-12)


@pytest.mark.parametrize(
    ("ratio", "friction", "x", "z", "value"),
    [
        pytest.param(0.5, 0.0, 0.0, 0.5, 0.458, marks=pytest.mark.slow),
        (2.0, 0.0, 0.0, 0.425, 0.854),
        (2.0, 0.25, 0.4, 0.375, 0.916),
        pytest.param(2.0, 0.5, 0.25, 1.0, 0.526, marks=pytest.mark.slow),
    ],
)
def test_catalogue_of_largest_von_mises(ratio, friction, x, z, value):
    """At the place where a search on a grid of 0.025 finds the largest value, it is that of the catalogue."""
    contact = coated(ratio)
    around = np.array([x - 0.1, x, x + 0.1])
    found = von_mises(coated_sliding(contact, around, 0.0 * around, z, friction=friction)) / P0
    assert found[1] == close(value, abs=1e-3)
    assert found[1] == found.max()


@pytest.mark.slow
@pytest.mark.parametrize(("ratio", "x", "value"), [(0.5, -0.31, 0.662), (1.0, -0.45, 0.898), (2.0, -0.73, 1.273)])
def test_catalogue_near_the_surface(ratio, x, value):
    contact = coated(ratio)
    points = contact.radius * np.linspace(x - 0.1, x + 0.1, 9)
    found = von_mises(coated_sliding(contact, points, 0.0 * points, 0.01, friction=0.5)) / P0
    assert found.max() == close(value, abs=1e-3)
    assert abs(int(found.argmax()) - 4) <= 1


@pytest.mark.slow
def test_extremes_of_thickness_and_modulus():
    """Limits: a coating of 1/50 contact radius hardly shows, nor does a coating 1000 times as thick show its base."""
    thin = coated(2.0, 0.02)
    assert thin.radius == close(A0, rel=0.02)
    thick = coated(1e3, 1e3)
    wanted = hertz.hertz_sphere(LOAD, RADIUS, 1e3 * MODULUS)
    # the approach keeps what the load does to the base from afar: P/(E h), as much as the contact itself
    assert [thick.radius, thick.max_pressure] == close(wanted[:2], rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(("ratio", "thickness"), [(1e3, 0.1), (1e4, 1.0), (1e-4, 1.0)])
def test_accuracy_at_great_contrast(monkeypatch, ratio, thickness):
    """Polynomials of a higher degree change nothing; a stiff thin coating carries the load at its rim."""
    layers, base = [(thickness, ratio, NU)], (1.0, NU)
    found = contact_of_radius(1.0, RADIUS, layers, base)
    monkeypatch.setattr("eigencontact_verification.oracles.coated_contact._DEGREE", 25)
    finer = contact_of_radius(1.0, RADIUS, layers, base)
    values = [[one.load, one.approach, one.max_pressure] for one in (found, finer)]
    assert values[0] == close(values[1], rel=1e-11)
    pressure = found.pressure(np.linspace(0.0, 1.0, 501))
    assert pressure.min() == 0.0
    assert found.max_pressure == close(pressure.max(), rel=1e-4)
    assert (found.max_pressure > 2.0 * pressure[0]) == (ratio == 1e3)
