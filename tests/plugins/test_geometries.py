"""Analytic geometries: shape, symmetry, junctions, closed forms, refusals."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.special import ellipkm1

from close import close
from eigencontact.plugin import Geometry, HasReferencePressure, SceneError
from eigencontact_plugins.geometries.cylinder import Cylinder
from eigencontact_plugins.geometries.ellipsoid import Ellipsoid, axis_ratio
from eigencontact_plugins.geometries.rounded_cone import RoundedCone
from eigencontact_plugins.geometries.rounded_punch import RoundedPunch
from eigencontact_plugins.geometries.sphere import Sphere
from eigencontact_verification.oracles import hertz

UM = 1e-6
TABLES = {
    "sphere": (Sphere, {"radius": 105 * UM}),
    "circle": (Sphere, {"radius": 105 * UM, "profile": "circle"}),
    "ellipsoid": (Ellipsoid, {"radius_x": 200 * UM, "radius_y": 50 * UM}),
    "cylinder": (Cylinder, {"radius": 100 * UM, "length": 40 * UM, "end_radius": 30 * UM}),
    "sharp cylinder": (Cylinder, {"radius": 100 * UM, "length": 40 * UM}),
    "rounded-punch": (RoundedPunch, {"flat_radius": 10 * UM, "edge_radius": 40 * UM}),
    "rounded-cone": (RoundedCone, {"half_angle": 1.3, "tip_radius": 20 * UM}),
}
every_geometry = pytest.mark.parametrize(("cls", "table"), TABLES.values(), ids=TABLES)
turned = pytest.mark.parametrize(("cls", "table"), [TABLES[n] for n in ("ellipsoid", "cylinder", "sharp cylinder")])

X = np.linspace(-50 * UM, 50 * UM, 22)[None, :]
Y = np.linspace(-40 * UM, 40 * UM, 17)[:, None]


# shape and symmetry -------------------------------------------------------------------------------------------------


@every_geometry
def test_first_touch_is_at_the_centre_with_separation_zero(cls, table):
    h = cls(**table, center=(3 * UM, -2 * UM)).separation(np.array([3 * UM, 5 * UM]), np.array([-2 * UM, 35 * UM]))
    assert h[0] == 0.0
    assert h[1] > 0.0


@every_geometry
def test_points_broadcast_and_are_left_alone(cls, table):
    x, y = X.copy(), Y.copy()
    x.flags.writeable = y.flags.writeable = False
    h = cls(**table).separation(x, y)
    assert h.shape == (17, 22)
    assert h.dtype == np.float64
    assert np.isfinite(h).all()
    assert h.min() >= 0.0


@every_geometry
def test_mirror_images_are_equal(cls, table):
    h = cls(**table).separation(X, Y)
    assert np.array_equal(h, cls(**table).separation(-X, Y))
    assert np.array_equal(h, cls(**table).separation(X, -Y))


@every_geometry
def test_centre_shifts_the_body(cls, table):
    shifted = cls(**table, center=(7 * UM, -4 * UM)).separation(X + 7 * UM, Y - 4 * UM)
    assert shifted == close(cls(**table).separation(X, Y), rel=1e-12, abs=1e-20)


@turned
def test_quarter_turn_exchanges_the_axes(cls, table):
    turned_body = cls(**table, angle=np.pi / 2)
    assert turned_body.separation(Y, X) == close(cls(**table).separation(X, Y), rel=1e-12, abs=1e-20)


@turned
def test_angle_turns_from_x_towards_y(cls, table):
    angle, x, y = 0.4, 9 * UM, 31 * UM
    at = (np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y)
    assert cls(**table, angle=angle).separation(*at) == close(cls(**table).separation(x, y), rel=1e-12)


@every_geometry
@pytest.mark.parametrize("scale", [1e-5, 1e4])
def test_shape_does_not_depend_on_the_unit_of_length(cls, table, scale):
    scaled = {k: v * scale if k not in ("half_angle", "profile") else v for k, v in table.items()}
    h = cls(**scaled).separation(X * scale, Y * scale)
    assert h / scale == close(cls(**table).separation(X, Y), rel=1e-12, abs=1e-20)


# values and junctions -----------------------------------------------------------------------------------------------


def test_parabola_and_circle_differ_by_the_next_term():
    R = 2.0
    r = np.array([0.02, 0.04, 0.08])
    excess = Sphere(radius=R, profile="circle").separation(r, 0.0) - Sphere(radius=R).separation(r, 0.0)
    assert excess == close(r**4 / (8 * R**3), rel=1e-3)


def test_circle_keeps_its_digits_near_the_tip():
    h = Sphere(radius=1.0, profile="circle").separation(1e-9, 0.0)
    assert float(h) == close(0.5e-18, rel=1e-14)


def test_circle_goes_on_beyond_the_radius_out_of_reach():
    circle = Sphere(radius=2.0, profile="circle")
    assert float(circle.separation(1.0, 0.0)) == close(2 - np.sqrt(3), rel=1e-15)
    assert circle.separation(np.array([2.0, 2.0 + 1e-9, 5.0]), 0.0) == close([2.0, 2.0, 5.0], rel=1e-8)
    assert float(circle.separation(2.0 - 1e-12, 0.0)) == close(2.0, rel=1e-5)


@pytest.mark.parametrize(
    ("geometry", "direction", "junction", "curvature"),
    [
        (RoundedPunch(flat_radius=2.0, edge_radius=5.0), (1.0, 0.0), 2.0, 1 / 5.0),
        (RoundedPunch(flat_radius=2.0, edge_radius=5.0), (0.6, 0.8), 2.0, 1 / 5.0),
        (RoundedCone(half_angle=1.3, tip_radius=5.0), (0.6, 0.8), 5.0 / np.tan(1.3), -1 / 5.0),
        (Cylinder(radius=3.0, length=4.0, end_radius=5.0), (0.0, 1.0), 2.0, 1 / 5.0),
    ],
    ids=["punch along x", "punch oblique", "cone", "cylinder end"],
)
def test_slope_is_continuous_and_curvature_jumps_at_the_junction(geometry, direction, junction, curvature):
    """Difference of the one-sided slopes over a step e is (jump of curvature) e/2 + O(e²), with no constant term."""
    steps = np.array([1e-2, 1e-3, 1e-4])

    def h(r):
        return geometry.separation(r * direction[0], r * direction[1])

    inner = h(junction) - h(junction - steps)
    outer = h(junction + steps) - h(junction)
    inner_curvature = (h(junction - 1e-3) - 2 * h(junction - 2e-3) + h(junction - 3e-3)) / 1e-6
    kink = (outer - inner) / steps - inner_curvature * steps
    assert kink == close(0.5 * curvature * steps, rel=1e-6, abs=2e-12)


def test_rounded_cone_has_the_slope_of_its_flank():
    cone = RoundedCone(half_angle=np.radians(70.3), tip_radius=1.0)
    slope = np.diff(cone.separation(np.array([8.0, 9.0]), 0.0))
    assert slope == close(1 / np.tan(np.radians(70.3)), rel=1e-14)


def test_rounded_punch_is_flat_inside_and_a_parabola_outside():
    punch = RoundedPunch(flat_radius=2.0, edge_radius=5.0)
    assert punch.separation(np.array([0.0, 1.9, 2.0, 3.0]), 0.0).tolist() == close([0, 0, 0, 0.1])


def test_cylinder_is_straight_along_its_axis_and_ends():
    sharp = Cylinder(radius=4.0, length=6.0)
    assert sharp.separation(2.0, np.array([-3.0, 0.0, 3.0])).tolist() == [0.5, 0.5, 0.5]
    assert sharp.separation(0.0, np.array([-3.001, 3.001])).tolist() == [10.0, 10.0]
    round_ended = Cylinder(radius=4.0, length=6.0, end_radius=2.0)
    assert round_ended.separation(0.0, np.array([-4.0, 4.0])).tolist() == [0.25, 0.25]


# closed forms -------------------------------------------------------------------------------------------------------

LOAD, E_STAR = 0.65, 230e9


@pytest.mark.parametrize("name", ["sphere", "circle", "ellipsoid", "rounded-punch", "rounded-cone"])
def test_closed_forms_are_offered_and_vanish_without_load(name):
    cls, table = TABLES[name]
    assert isinstance(cls(**table), HasReferencePressure)
    assert not cls(**table).reference_pressure(X, Y, 0.0, E_STAR).any()
    assert cls(**table).reference_pressure(X, Y, LOAD, E_STAR).shape == (17, 22)


def test_cylinder_of_finite_length_claims_no_closed_form():
    assert not isinstance(Cylinder(radius=1.0, length=1.0), HasReferencePressure)


def test_sphere_pressure_is_the_oracle():
    a, p0, _ = hertz.hertz_sphere(LOAD, 105 * UM, E_STAR)
    x, y = X / (50 * UM) * 1.2 * a, Y / (40 * UM) * 1.2 * a
    sphere = Sphere(radius=105 * UM, center=(UM, 2 * UM))
    found = sphere.reference_pressure(x + UM, y + 2 * UM, LOAD, E_STAR)
    assert found == close(hertz.pressure(x, y, a, a, p0), abs=1e-8 * p0)
    assert float(sphere.reference_pressure(UM, 2 * UM, LOAD, E_STAR)) == close(p0, rel=1e-14)


@pytest.mark.parametrize("ratio", [1e-4, 0.3, 1.0, 1.0 + 1e-9, 1.0 + 1e-6, 1.0009, 1.0011, 1.5, 1e2, 1e4])
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_ellipsoid_pressure_is_the_oracle(ratio, angle):
    rx, ry = 105 * UM * ratio, 105 * UM
    a, b, p0, _ = hertz.hertz_ellipse(LOAD, rx, ry, E_STAR)
    xi, eta = np.linspace(-1.1, 1.1, 24)[None, :] * a, np.linspace(-1.1, 1.1, 22)[:, None] * b  # off the edge
    x, y = np.cos(angle) * xi - np.sin(angle) * eta, np.sin(angle) * xi + np.cos(angle) * eta
    found = Ellipsoid(radius_x=rx, radius_y=ry, angle=angle).reference_pressure(x, y, LOAD, E_STAR)
    assert found == close(hertz.pressure(xi, eta, a, b, p0), rel=1e-9)


@pytest.mark.parametrize("ratio", [1.0, 1.0 + 3e-8, 1.0009, 1.0011, 1.01, 3.0, 1e2, 1e4, 1e8])
def test_axis_ratio_solves_the_equation_of_the_oracle(ratio):
    a, b, _, _ = hertz.hertz_ellipse(1.0, ratio, 1.0, 1.0)
    assert axis_ratio(ratio) == close(b / a, rel=3e-12)


def double_exponential(low, high, half_range=3.4, number=221):
    """Nodes and weights on (low, high) that stand a logarithm or a root at either end."""
    t = np.linspace(-half_range, half_range, number)
    u = 0.5 * np.pi * np.sinh(t)
    position = 1.0 / (1.0 + np.exp(-2.0 * u))
    weight = 0.25 * np.pi * np.cosh(t) / np.cosh(u) ** 2 * (t[1] - t[0])
    return low + (high - low) * position, (high - low) * weight


REVOLUTION = [
    (Sphere(radius=3.0), 1.0, 0.0),
    (Sphere(radius=3.0, profile="circle"), 1e-3, 0.0),
    (Sphere(radius=3.0, profile="circle"), 4.0, 0.0),
    (RoundedPunch(flat_radius=1.0, edge_radius=2.0), 1e-3, 1.0),
    (RoundedPunch(flat_radius=1.0, edge_radius=2.0), 1.0, 1.0),
    (RoundedPunch(flat_radius=1.0, edge_radius=2.0), 40.0, 1.0),
    (RoundedCone(half_angle=1.2, tip_radius=2.0), 1e-2, 2.0 / np.tan(1.2)),
    (RoundedCone(half_angle=1.2, tip_radius=2.0), 1.0, 2.0 / np.tan(1.2)),
    (RoundedCone(half_angle=1.2, tip_radius=2.0), 40.0, 2.0 / np.tan(1.2)),
]
REVOLUTION_IDS = [f"{geometry.key}-{load}" for geometry, load, _ in REVOLUTION]


@cache
def radius_of_contact(geometry, load):
    """Where the closed form ends, by bisection."""
    low, high = 0.0, 100.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        touching = geometry.reference_pressure(np.array([middle]), 0.0, load, 1.0)[0] > 0
        low, high = (middle, high) if touching else (low, middle)
    return high


def over_disk(geometry, load, a, breaks, kernel):
    """∫ p(s) kernel(s) ds from 0 to a, split at `breaks`."""
    ends = sorted({0.0, a, *(b for b in breaks if 0 < b < a)})
    total = 0.0
    for low, high in pairwise(ends):
        s, weight = double_exponential(low, high)
        total += np.sum(weight * geometry.reference_pressure(s, np.zeros_like(s), load, 1.0) * kernel(s))
    return total


@pytest.mark.parametrize(("geometry", "load", "junction"), REVOLUTION, ids=REVOLUTION_IDS)
def test_pressure_of_revolution_carries_the_load(geometry, load, junction):
    a = radius_of_contact(geometry, load)
    assert over_disk(geometry, load, a, [junction], lambda s: 2 * np.pi * s) == close(load, rel=1e-11)


@pytest.mark.parametrize(("geometry", "load", "junction"), REVOLUTION, ids=REVOLUTION_IDS)
def test_pressure_of_revolution_closes_the_gap(geometry, load, junction):
    """Displacement of rings of pressure (K. L. Johnson 1985, eq. 3.96) plus separation is the same at all radii.

    u(r) = 4/(π E*) ∫ p(s) s/(r+s) K(m) ds with 1 - m = ((r-s)/(r+s))². Outside the contact the gap is open.
    """
    a = radius_of_contact(geometry, load)

    def level(r):
        def kernel(s):
            modulus = np.maximum(np.abs(r - s) / (r + s), 1e-150)
            return 4 / np.pi * s / (r + s) * ellipkm1(modulus**2)

        return over_disk(geometry, load, a, [junction, r], kernel) + float(geometry.separation(r, 0.0))

    levels = np.array([level(fraction * a) for fraction in (1e-9, 0.3, 0.6, 0.95)])
    assert levels == close(levels[0], rel=1e-11)
    assert level(1.02 * a) > levels[0] * (1 + 1e-3)


def test_circle_tends_to_hertz_with_the_square_of_the_load_to_two_thirds():
    """a/R ~ P^(1/3), so that the relative difference of the peaks falls with P^(2/3): rate and bound, both sides."""
    loads = np.array([1e-3, 1e-4, 1e-5])
    peak = [
        [float(Sphere(radius=1.0, profile=p).reference_pressure(np.zeros(1), 0.0, load, 1.0)[0]) for load in loads]
        for p in ("circle", "parabola")
    ]
    difference = np.abs(np.divide(*peak) - 1.0)
    rate = np.polyfit(np.log(loads), np.log(difference), 1)[0]
    assert rate == close(2 / 3, abs=0.01)
    assert difference[-1] < 1e-3


@pytest.mark.parametrize("name", ["sphere", "circle", "ellipsoid", "rounded-punch", "rounded-cone"])
@pytest.mark.parametrize("scale", [1e-5, 1e4])
def test_closed_forms_do_not_depend_on_the_unit_of_length(name, scale):
    cls, table = TABLES[name]
    scaled = {k: v * scale if k not in ("half_angle", "profile") else v for k, v in table.items()}
    found = cls(**scaled).reference_pressure(0.2 * X * scale, 0.2 * Y * scale, LOAD * scale**2, E_STAR)
    expected = cls(**table).reference_pressure(0.2 * X, 0.2 * Y, LOAD, E_STAR)
    assert expected.max() > 0
    assert found == close(expected, rel=1e-9, abs=1e-7 * expected.max())


@pytest.mark.parametrize("fraction", [0.01, 0.3, 0.7, 0.95])
def test_circle_reaches_the_radius_of_sneddons_load(fraction):
    """P = E* [(R² + a²)/2 ln((R+a)/(R-a)) - a R] for the exact sphere (I. N. Sneddon 1965)."""
    R, a = 3.0, 3.0 * fraction
    load = 0.5 * (R * R + a * a) * np.log((R + a) / (R - a)) - a * R
    assert radius_of_contact(Sphere(radius=R, profile="circle"), load) == close(a, rel=1e-9)


def test_circle_has_no_closed_form_for_a_load_that_no_contact_carries():
    assert np.isnan(Sphere(radius=1.0, profile="circle").reference_pressure(np.zeros(2), 0.0, 25.0, 1.0)).all()


def test_punch_without_flat_and_cone_with_light_load_are_hertz():
    r = np.linspace(0, 1.5, 40)
    sphere = Sphere(radius=2.0).reference_pressure(r, 0.0, 0.3, 1.0)
    punch = RoundedPunch(flat_radius=1e-7, edge_radius=2.0).reference_pressure(r, 0.0, 0.3, 1.0)
    cone = RoundedCone(half_angle=0.3, tip_radius=2.0).reference_pressure(r, 0.0, 0.3, 1.0)
    assert punch == close(sphere, rel=1e-5)
    assert cone == close(sphere, rel=1e-10)


def test_cone_far_beyond_its_tip_is_sneddons():
    half_angle, load = 1.2, 5.0
    a = radius_of_contact(RoundedCone(half_angle=half_angle, tip_radius=1e-4), load)
    assert a == close(np.sqrt(2 * load * np.tan(half_angle) / np.pi), rel=1e-5)
    found = RoundedCone(half_angle=half_angle, tip_radius=1e-4).reference_pressure(np.array([0.3 * a]), 0.0, load, 1.0)
    assert found == close(0.5 / np.tan(half_angle) * np.arccosh(1 / 0.3), rel=1e-5)


# refusals -----------------------------------------------------------------------------------------------------------

POSITIVE = "positive and finite [m]"


@pytest.mark.parametrize(
    ("cls", "table", "message"),
    [
        (Sphere, {"radius": 0.0}, f"sphere.radius must be {POSITIVE} (got 0.0)"),
        (Sphere, {"radius": float("nan")}, f"sphere.radius must be {POSITIVE} (got nan)"),
        (Sphere, {"radius": float("inf")}, f"sphere.radius must be {POSITIVE} (got inf)"),
        (
            Sphere,
            {"radius": 1.0, "profile": "round"},
            "sphere.profile must be 'parabola' or 'circle' (got 'round')",
        ),
        (
            Sphere,
            {"radius": 1.0, "center": (0.0, float("nan"))},
            "sphere.center must be two finite lengths (x, y) (got (0.0, nan))",
        ),
        (
            Sphere,
            {"radius": 1.0, "center": (0.0,)},
            "sphere.center must be two finite lengths (x, y) (got (0.0,))",
        ),
        (Ellipsoid, {"radius_x": -1.0, "radius_y": 1.0}, f"ellipsoid.radius_x must be {POSITIVE} (got -1.0)"),
        (Ellipsoid, {"radius_x": 1.0, "radius_y": 0.0}, f"ellipsoid.radius_y must be {POSITIVE} (got 0.0)"),
        (
            Ellipsoid,
            {"radius_x": 1.0, "radius_y": 1.0, "angle": float("inf")},
            "ellipsoid.angle must be finite [rad] (got inf)",
        ),
        (Cylinder, {"radius": 0.0, "length": 1.0}, f"cylinder.radius must be {POSITIVE} (got 0.0)"),
        (Cylinder, {"radius": 1.0, "length": -2.0}, f"cylinder.length must be {POSITIVE} (got -2.0)"),
        (
            Cylinder,
            {"radius": 1.0, "length": 1.0, "end_radius": -1.0},
            "cylinder.end_radius must be finite and not negative [m] (0: sharp ends) (got -1.0)",
        ),
        (
            RoundedPunch,
            {"flat_radius": 0.0, "edge_radius": 1.0},
            f"rounded-punch.flat_radius must be {POSITIVE} (got 0.0)",
        ),
        (
            RoundedPunch,
            {"flat_radius": 1.0, "edge_radius": 0.0},
            f"rounded-punch.edge_radius must be {POSITIVE} (got 0.0)",
        ),
        (
            RoundedCone,
            {"half_angle": 2.0, "tip_radius": 1.0},
            "rounded-cone.half_angle must be between 0 and π/2 [rad], from the axis to the flank (got 2.0)",
        ),
        (
            RoundedCone,
            {"half_angle": 1.0, "tip_radius": 0.0},
            f"rounded-cone.tip_radius must be {POSITIVE} (got 0.0)",
        ),
    ],
)
def test_refusals_name_the_field_the_rule_and_the_value(cls, table, message):
    with pytest.raises(SceneError) as caught:
        cls(**table)
    assert str(caught.value) == message


@every_geometry
def test_each_is_a_geometry_with_its_table_as_fields(cls, table):
    component = cls(**table)
    assert isinstance(component, Geometry)
    assert component == cls(**table)
    assert hash(component) == hash(cls(**table))
