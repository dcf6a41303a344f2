"""Uniformly loaded rectangles: against quadrature, field equations, exact symmetries, transforms and Hertz."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from close import close
from eigencontact.core.symmetry import parity
from eigencontact.core.tensors import from_mandel, to_matrix
from eigencontact.hooks.manager import load_plugins
from eigencontact.plugin import COMPONENTS, KINDS, HasWavenumberResponse, Material
from eigencontact_plugins import surface_loads
from eigencontact_plugins.surface_loads import PressureLoad, ShearLoadX, ShearLoadY
from eigencontact_verification.oracles import hertz
from eigencontact_verification.oracles.boussinesq import point_force, rectangle

LOADS = (PressureLoad(), ShearLoadX(), ShearLoadY())
AXIS = {"p": "z", "q_x": "x", "q_y": "y"}
POISSON = (-0.5, 0.0, 0.3, 0.499999, 0.5)


def material(nu, G=1.0):
    return Material(young_modulus=2 * G * (1 + nu), poisson_ratio=nu)


def field(load, x, y, z, widths, nu):
    """Displacement x, y, z for G = 1 and plain stress components, (9, ...)."""
    x, y, z = (np.asarray(c, dtype=float) for c in (x, y, z))
    u = load.displacement(("x", "y", "z"), x, y, z, widths, material(nu))
    return np.concatenate([u, from_mandel(load.stress(COMPONENTS, x, y, z, widths, material(nu)))])


# --- the oracle's point forces: nothing of them is taken on trust ------------------------------------------------


@pytest.mark.parametrize("nu", [-0.5, 0.3, 0.49])
@pytest.mark.parametrize("load", ["p", "q_x", "q_y"])
def test_point_forces_of_the_oracle_satisfy_hooke_and_equilibrium(load, nu):
    rng = np.random.default_rng(1)
    points = rng.uniform(-1, 1, (3, 50))
    points[2] = np.abs(points[2]) + 0.05
    step = 1e-30  # complex step: derivatives to round-off

    def derivative(axis):
        moved = points.astype(complex)
        moved[axis] += 1j * step
        return point_force(load, *moved, nu).imag / step

    d = np.array([derivative(axis) for axis in range(3)])  # (axis, field, point)
    value = point_force(load, *points, nu)
    grad = d[:, :3]
    strain = 0.5 * (grad + grad.transpose(1, 0, 2))
    stress = 2 * (strain + nu / (1 - 2 * nu) * np.trace(strain) * np.eye(3)[:, :, None])
    xx, yy, zz, yz, xz, xy = value[3:]
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    assert np.abs(stress - tensor).max() < 1e-12 * np.abs(tensor).max()
    rows = ((3, 8, 7), (8, 4, 6), (7, 6, 5))  # positions of sigma_ij in the field
    for row in rows:
        divergence = d[0, row[0]] + d[1, row[1]] + d[2, row[2]]
        assert np.all(np.abs(divergence) < 1e-12 * np.abs(d[:, 3:]).max())
    free = point_force(load, points[0], points[1], np.zeros(50), nu)[[5, 6, 7]]
    assert np.abs(free).max() == 0.0


@pytest.mark.parametrize(("load", "component"), [("p", 5), ("q_x", 7), ("q_y", 6)])
def test_point_forces_of_the_oracle_have_unit_strength(load, component):
    """The traction on the plane z = 1 balances the force: polar integral with r = tan t."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    t, weight = np.pi / 4 * (nodes + 1), np.pi / 4 * weights
    theta = 2 * np.pi * np.arange(8) / 8
    r = np.tan(t)[:, None]
    values = point_force(load, r * np.cos(theta), r * np.sin(theta), np.array(1.0), 0.3)[component]
    total = (values.mean(axis=1) * 2 * np.pi * r[:, 0] / np.cos(t) ** 2 * weight).sum()
    assert total == close(-1.0, abs=1e-12)


# --- kernels against the oracle ----------------------------------------------------------------------------------

# Field points in units of the longest half width; where they lie on an edge or a corner z is positive.
NEAR = [
    (0.0, 0.0, 0.0), (0.3, 0.2, 0.0), (0.3, 0.2, 0.5), (-0.7, 0.1, 0.02), (0.2, 0.1, 1e-6), (0.999999, 0.2, 1e-7),
    (1.0, 0.0, 0.3), (1.0, 0.3, 1e-9), (1.0, 1.0, 0.4), (-1.0, 1.0, 1e-3), (1.0001, 1.0, 0.0), (1.5, 0.7, 0.0),
    (0.0, 2.0, 0.01), (2.5, 1.0, 0.0), (1.0, -3.0, 0.0), (0.0, 0.0, 2.9),
]  # fmt: skip
FAR = [
    # just inside and just outside of each radius where the rule of integration changes
    (0.0, 0.0, 0.499), (0.0, 0.0, 0.501), (0.0, 0.0, 1.01), (0.0, 0.0, 2.49), (0.0, 0.0, 2.51), (3.51, 0.0, 0.0),
    (0.0, 0.0, 6.01), (25.1, 0.0, 0.0), (3.0, 2.0, 401.0),
    (2.0, 2.0, 2.0), (0.1, 2.9, 0.1), (30.0, -20.0, 5.0),
    (1e3, 10.0, 3.0), (1e4, 1.0, 0.0), (1e4, 1e4, 1e4), (1e5, 0.0, 0.0), (0.0, 0.0, 1e5),
]  # fmt: skip
WIDTHS = [(1.0, 1.0), (1.0, 0.3), (1.0, 1e-3), (1e-3, 1.0)]


@pytest.mark.parametrize(
    ("widths", "nu"),
    [
        pytest.param(w, nu, marks=() if nu in (0.3, 0.5) else pytest.mark.slow, id=f"{w}-{nu}")
        for w in WIDTHS
        for nu in POISSON
        if min(w) > 0.1 or nu in (0.3, 0.5)
    ],
)
def test_fields_agree_with_quadrature(widths, nu):
    """Error relative to the largest component over the three loads, displacement and stress apart.

    Measured: 6e-15 (u) and 7e-13 (stress) for moderate shapes, 2e-13 and 7e-13 for edges 1:1000.
    """
    points = NEAR + FAR
    ours = np.array([field(load, *np.transpose(points), widths, nu) for load in LOADS])
    oracle = np.transpose([[rectangle(load.traction, p, widths, nu) for p in points] for load in LOADS], (0, 2, 1))
    for part in (slice(0, 3), slice(3, 9)):
        error = np.abs(ours[:, part] - oracle[:, part]).max(axis=(0, 1)) / np.abs(oracle[:, part]).max(axis=(0, 1))
        assert error.max() < 5e-12, (points[error.argmax()], part)


@pytest.mark.parametrize("point", [(1, 0, 0), (1, 0.5, 0), (0.2, -1, 0), (1, 1, 0), (-1, 1, 0)], ids=str)
def test_displacement_on_edges_and_corners(point):
    for load in LOADS:
        ours, oracle = field(load, *point, (1, 1), 0.3)[:3], rectangle(load.traction, point, (1, 1), 0.3)[:3]
        assert np.abs(ours - oracle).max() < 1e-13 * np.abs(oracle).max()


# --- closed forms on the surface ---------------------------------------------------------------------------------


@pytest.mark.parametrize("nu", POISSON)
@pytest.mark.parametrize(("half_x", "half_y"), [(1.0, 1.0), (2.0, 0.5), (1e-6, 1e-6), (1e-9, 1e-6)])
def test_love_centre(half_x, half_y, nu):
    mat = Material(young_modulus=210e9, poisson_ratio=nu)
    ours = PressureLoad().displacement("z", np.zeros(1), np.zeros(1), 0.0, (half_x, half_y), mat)[0, 0]
    assert ours == close(hertz.love_centre_displacement(1.0, half_x, half_y, 210e9, nu), rel=1e-12, abs=0)


@pytest.mark.parametrize(("load", "component"), [(LOADS[0], "zz"), (LOADS[1], "xz"), (LOADS[2], "yz")])
def test_traction_on_the_surface_is_the_load(load, component):
    """-1 under the load, 0 beside it, the mean on edges and corners; the other two tractions vanish."""
    x, y = np.meshgrid([-3.0, -1.0, -0.999, 0.0, 0.3, 1.0, 1.001, 2.0], [-2.0, -0.5, 0.0, 0.5, 0.7])
    inside = np.where(np.abs(x) == 1, 0.5, np.abs(x) < 1) * np.where(np.abs(y) == 0.5, 0.5, np.abs(y) < 0.5)
    stress = from_mandel(load.stress(COMPONENTS, x, y, 0.0, (1.0, 0.5), material(0.3)))
    for name in ("zz", "yz", "xz"):
        expected = -inside if name == component else np.zeros_like(inside)
        assert np.abs(stress[COMPONENTS.index(name)] - expected).max() < 1e-15


@pytest.mark.parametrize("nu", POISSON)
def test_reciprocity(nu):
    """Work of one load on the displacement of another: the kernel of the pair, mirrored, is the same."""
    rng = np.random.default_rng(3)
    x, y = rng.uniform(-2, 2, (2, 200))
    p, qx, qy = (load.displacement("xyz", x, y, 0.0, (0.7, 0.4), material(nu)) for load in LOADS)
    scale = np.abs(p[2]).max()
    for left, right in ((qx[2], -p[0]), (qy[2], -p[1]), (qx[1], qy[0])):
        assert np.abs(left - right).max() < 1e-14 * scale
    assert np.abs(qx[1]).max() > 1e-3 * scale or nu == 0.0


# --- field equations ---------------------------------------------------------------------------------------------


def gradient(function, points, h=0.02):
    """First derivatives, (axis, ...), by central differences extrapolated to order 8."""
    weights = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}
    out = []
    for axis in range(3):
        step = np.zeros((3, 1))
        step[axis] = h
        out.append(sum(w * (function(points + k * step) - function(points - k * step)) for k, w in weights.items()) / h)
    return np.array(out)


@pytest.mark.parametrize("nu", [*(pytest.param(nu, marks=pytest.mark.slow) for nu in (-0.5, 0.0)), 0.3, 0.49])
@pytest.mark.parametrize(
    "load", [pytest.param(load, id=load.key, marks=[pytest.mark.slow] * (load.key == "shear-y")) for load in LOADS]
)
def test_hooke_and_equilibrium(load, nu):
    rng = np.random.default_rng(5)
    points = np.vstack([rng.uniform(-2, 2, (2, 60)), rng.uniform(0.7, 2.5, 60)])
    points[:, :3] = [[1.0, 0.0, 1.0], [0.0, 0.5, 0.5], [0.7, 0.8, 0.9]]  # under edges and a corner
    widths = (1.0, 0.5)
    grad = gradient(lambda q: field(load, *q, widths, nu)[:3], points)
    strain = 0.5 * (grad + grad.transpose(1, 0, 2))
    hooke = 2 * (strain + nu / (1 - 2 * nu) * np.trace(strain) * np.eye(3)[:, :, None])
    mandel = load.stress(COMPONENTS, *points, widths, material(nu))
    tensor = np.moveaxis(to_matrix(mandel), 0, -1)
    # differences of order 8 at h = 0.02, z >= 0.7: truncation about 1e-9
    assert np.abs(hooke - tensor).max() < 2e-9 * np.abs(tensor).max() / (1 - 2 * nu)
    slopes = gradient(
        lambda q: np.moveaxis(to_matrix(load.stress(COMPONENTS, *q, widths, material(nu))), 0, -1), points
    )
    divergence = np.einsum("iijp->jp", slopes)
    assert np.abs(divergence).max() < 2e-9 * np.abs(slopes).max()


# --- exact symmetries --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("unit", [1e-9, 1e-6, 3.0, 1e6])
@pytest.mark.parametrize("load", LOADS, ids=lambda load: load.key)
def test_length_scaling(load, unit):
    x, y = np.meshgrid([-30.0, -1.0, 0.0, 0.3, 1.0, 2.5], [-0.4, 0.0, 0.1, 0.4, 7.0])
    for z in (0.0, 0.2):
        reference = field(load, x, y, z, (1.0, 0.4), 0.3)
        scaled = field(load, unit * x, unit * y, unit * z, (unit, unit * 0.4), 0.3)
        scaled[:3] /= unit
        # points on singular lines may leave them by one rounding, where the logarithm is not the same
        regular = (np.abs(x) != 1.0) & (np.abs(y) != 0.4) if z == 0 else np.ones(x.shape, dtype=bool)
        error = np.abs(scaled - reference)[:, regular]
        assert error.max() < 1e-12
        assert np.abs(scaled[:3] - reference[:3]).max() < 1e-12


@settings(max_examples=10, deadline=None)
@given(
    x=st.floats(-20, 20),
    y=st.floats(-20, 20),
    a=st.floats(0.05, 3),
    b=st.floats(0.05, 3),
    nu=st.floats(-0.9, 0.5),
)
def test_mirrors_and_quarter_turn(x, y, a, b, nu):
    """Mirrored or turned with its load, the field is the mirrored or turned field, to round-off."""
    x, y, z = np.broadcast_arrays(x, y, [0.0, 1e-8, 0.3, 4.0])
    original = {load.traction: field(load, x, y, z, (a, b), nu) for load in LOADS}
    names = ("x", "y", "z", *COMPONENTS)
    scale = np.abs(list(original.values())).max(axis=(0, 1))
    for load in LOADS:
        signs = np.array([parity(name, AXIS[load.traction]) for name in names]).T
        for sign, mirrored in zip(signs, ((x, -y), (-x, y)), strict=True):
            error = field(load, *mirrored, z, (a, b), nu) - sign[:, None] * original[load.traction]
            assert np.all(np.abs(error) <= 1e-13 * scale)
    # turn by 90 degrees: e_x -> e_y, e_y -> -e_x; the traction q_x becomes q_y
    turned = (-y, x, z, (b, a), nu)
    index = {name: i for i, name in enumerate(names)}
    image = {"x": (1, "y"), "y": (-1, "x"), "z": (1, "z"), "xx": (1, "yy"), "yy": (1, "xx"), "zz": (1, "zz")}
    image |= {"yz": (-1, "xz"), "xz": (1, "yz"), "xy": (-1, "xy")}
    for load, partner in ((LOADS[0], "p"), (LOADS[2], "q_x")):
        values = field(load, *turned)
        for name, (sign, target) in image.items():
            assert np.all(np.abs(values[index[target]] - sign * original[partner][index[name]]) <= 1e-12 * scale)


@pytest.mark.parametrize("z", [0.0, 0.35])
@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_rectangle_is_the_sum_of_its_halves(z, nu):
    rng = np.random.default_rng(8)
    x, y = rng.uniform(-9, 9, (2, 300))
    for load in LOADS:
        whole = field(load, x, y, z, (1.0, 0.6), nu)
        halves = field(load, x - 0.5, y, z, (0.5, 0.6), nu) + field(load, x + 0.5, y, z, (0.5, 0.6), nu)
        assert np.abs(whole - halves).max() < 1e-13 * np.abs(whole).max()


# --- lattices ----------------------------------------------------------------------------------------------------

LATTICES = {
    "quadrant": (np.arange(7), np.arange(7)),
    "not square": (np.arange(5), np.arange(8)),
    "centred odd": (np.arange(-3, 4), np.arange(-2, 3)),
    "centred even": (np.arange(-4, 4), np.arange(-4, 4)),
    "nodes on the axes": (np.arange(4) + 0.5, np.arange(3) - 0.5),
    "one cell": (np.arange(1), np.arange(1)),
    "long": (np.arange(300), np.arange(2)),
}


@pytest.mark.parametrize("name", LATTICES)
@pytest.mark.parametrize("z", [0.0, 0.45])
@pytest.mark.parametrize("half_widths", [(0.5e-6, 0.5e-6), (0.5e-6, 0.8e-6)])
def test_sample_equals_pointwise(name, z, half_widths):
    """Within rounding of the nodal values, which grow like the extent of the lattice."""
    a, b = half_widths
    x, y = 2 * a * LATTICES[name][0], 2 * b * LATTICES[name][1]
    at_corners = z == 0 and name == "nodes on the axes"  # the field points then lie on corners: singular
    mat = material(0.3, 80e9)
    for load in LOADS:
        for quantity, components in (("displacement", ("z",)), ("displacement", "xyz"), ("stress", COMPONENTS)):
            if quantity == "stress" and at_corners:
                continue
            sampled = load.sample(quantity, components, x, y, z * a, half_widths, mat)
            exact = getattr(load, quantity)(components, x[None, :], y[:, None], z * a, half_widths, mat)
            assert sampled.shape == (len(components), y.size, x.size)
            scale = np.abs(getattr(load, quantity)(components, 0.3 * a, 0.3 * b, z * a, half_widths, mat)).max()
            assert np.abs(sampled - exact).max() < 1e-14 * max(x.size, y.size, 20) * scale


def test_only_what_is_asked_for_and_in_that_order():
    x, y = np.array([0.2, 3.0]), np.array([0.1, -8.0])
    for load in LOADS:
        whole = load.stress(COMPONENTS, x, y, 0.4, (1, 1), material(0.3))
        assert np.array_equal(load.stress(("xy", "zz"), x, y, 0.4, (1, 1), material(0.3)), whole[[5, 2]])
        vector = load.displacement("xyz", x, y, 0.4, (1, 1), material(0.3))
        assert np.array_equal(load.displacement(("z", "x"), x, y, 0.4, (1, 1), material(0.3)), vector[[2, 0]])


def test_finite_everywhere_without_a_warning():
    """Every special point at once: centre, edges, corners, their extensions, a rounding beside them, and depth 0."""
    eps = 2.3e-16
    line = np.array([-1e5, -3, -1 - eps, -1, -1 + eps, -1e-200, 0, 5e-324, 0.3, 1 - eps, 1, 1 + eps, 1.7, 3, 1e5])
    z = np.array([-0.0, 0.0, 5e-324, 1e-200, 1e-40, 1e-16, 1e-3, 1.0, 1e5])
    x, y, z = line[:, None, None], line[None, :, None], z[None, None, :]
    for load in LOADS:
        for nu in (-0.9, 0.3, 0.5):
            for widths in ((1.0, 1.0), (1.0, 1e-3)):
                values = field(load, x, y, z, widths, nu)
                assert np.isfinite(values).all()
                assert np.abs(values).max() < 100  # a logarithm of 1e-30 is 69
                assert np.array_equal(values[..., 0], values[..., 1])  # the sign of a zero depth means nothing


def test_true_singularities_are_large_and_of_the_right_sign():
    def corner_and_beside(load, component, x, y):
        on = load.stress([component], np.array(x), np.array(y), 0.0, (1, 1), material(0.3))[0]
        beside = load.stress(
            [component], np.array(x * (1 + 1e-9)), np.array(y * (1 + 1e-9)), 0.0, (1, 1), material(0.3)
        )
        return float(on), float(beside[0])

    for load, component, x, y in (
        (LOADS[0], "xy", 1.0, 1.0),
        (LOADS[0], "xy", -1.0, 1.0),
        (LOADS[1], "xx", 1.0, 0.2),
        (LOADS[1], "xx", -1.0, 0.2),
        (LOADS[1], "yy", 1.0, 0.2),
        (LOADS[1], "xy", 0.2, 1.0),
        (LOADS[2], "yy", 0.2, -1.0),
    ):
        on, beside = corner_and_beside(load, component, x, y)
        assert np.sign(on) == np.sign(beside)
        assert abs(beside) < abs(on) < 100


# --- traction waves ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("nu", [-0.5, 0.3, 0.5])
@pytest.mark.parametrize(("z", "places"), [(0.7, [(0.0, 0.0), (0.3, -0.2)]), (1.0, [(-1.5, 0.8)])])
def test_waves_add_up_to_the_rectangle(z, places, nu):
    """Inverse transform of (transform of the rectangle x response) in polar coordinates of the wave vector."""
    a, b, count = 0.6, 0.4, 192
    nodes, weights = np.polynomial.legendre.leggauss(20)
    panels = 2.0 * np.arange(29)  # up to k = 58: exp(-kz) < 1e-17
    k = (panels[:, None] + 1 + nodes).ravel()[:, None]
    weight = np.tile(weights, panels.size)[:, None] * 2 * np.pi / count
    theta = 2 * np.pi * (np.arange(count) + 0.5) / count
    kx, ky = k * np.cos(theta), k * np.sin(theta)
    transform = 4 * a * b * np.sinc(kx * a / np.pi) * np.sinc(ky * b / np.pi) * k * weight / (4 * np.pi**2)
    shifts = [transform * np.exp(1j * (kx * x + ky * y)) for x, y in places]
    for load in LOADS:
        assert isinstance(load, HasWavenumberResponse)
        u = load.wavenumber_response("displacement", "xyz", kx, ky, z, material(nu))
        s = load.wavenumber_response("stress", COMPONENTS, kx, ky, z, material(nu))
        values = np.concatenate([u, from_mandel_complex(s)])
        for shift, (x, y) in zip(shifts, places, strict=True):
            total = np.einsum("ckt,kt->c", values, shift)
            expected = field(load, x, y, z, (a, b), nu)
            assert np.abs(total.imag).max() < 1e-13
            assert np.abs(total.real - expected).max() < 1e-12 * np.abs(expected).max()


def from_mandel_complex(mandel):
    return from_mandel(mandel.real) + 1j * from_mandel(mandel.imag)


def test_waves_at_the_surface_deep_down_and_of_zero_wavenumber():
    kx, ky = np.array([0.0, 2.0, 3.0]), np.array([0.0, -1.0, 0.0])
    for load, name in zip(LOADS, ("zz", "xz", "yz"), strict=True):
        surface = load.wavenumber_response("stress", COMPONENTS, kx, ky, 0.0, material(0.3))
        deep = load.wavenumber_response("stress", COMPONENTS, kx, ky, 1e9, material(0.3))
        for component in ("zz", "yz", "xz"):
            expected = (-1.0 if component == name else 0.0) * (1.0 if component == "zz" else np.sqrt(2))
            row = COMPONENTS.index(component)
            assert np.abs(surface[row] - expected).max() < 1e-15
            assert abs(deep[row, 0] - expected) < 1e-15  # a uniform traction does not decay
        assert np.abs(surface[[0, 1, 5], 0]).max() == 0.0  # in-plane stress at k = 0: by convention
        assert np.abs(deep[:, 1:]).max() == 0.0  # exp(-kz) underflows quietly
        for z in (0.0, 1e9):
            assert np.abs(load.wavenumber_response("displacement", "xyz", kx, ky, z, material(0.3))[:, 0]).max() == 0
        assert load.wavenumber_response("displacement", "z", kx[:, None], ky, 0.0, material(0.3)).shape == (1, 3, 3)


def test_wave_on_the_surface_has_the_plane_strain_compliance():
    """A pressure cos(kx) lifts the surface by 2 (1 - nu^2)/(E k): the half-plane result, Johnson 1985 eq. 13.1."""
    mat = Material(young_modulus=3.0, poisson_ratio=0.2)
    response = PressureLoad().wavenumber_response("displacement", "z", np.array([5.0]), np.array([0.0]), 0.0, mat)
    assert response[0, 0] == close(2 * (1 - 0.04) / (3.0 * 5.0), rel=1e-14)


# --- Hertz pressure as a sum of rectangles -----------------------------------------------------------------------

CELLS = (8, 16, 32, 64)


def axis_error(load, component, z, n, exact):
    """Error on the axis of a Hertz traction averaged over cells of edge a/n (8 x 8 points a cell)."""
    h = 1.0 / n
    x = np.arange(-n - 1, n + 2) * h
    fine = (x[:, None] + h * ((np.arange(8) + 0.5) / 8 - 0.5)).ravel()
    pressure = np.sqrt(np.maximum(1 - fine[:, None] ** 2 - fine**2, 0)).reshape(x.size, 8, x.size, 8).mean((1, 3))
    coefficients = load.sample("stress", [component], x, x, z, (h / 2, h / 2), material(0.3))[0]
    factor = 1.0 if component[0] == component[1] else np.sqrt(2)
    return float((pressure * coefficients).sum() / factor - exact)


@pytest.mark.parametrize(
    ("load", "component", "z", "exact"),
    [
        (ShearLoadX(), "xz", 0.2, hertz.axis_shear_sliding(0.2)),
        (ShearLoadX(), "xz", 0.5, hertz.axis_shear_sliding(0.5)),
        (ShearLoadY(), "yz", 0.5, hertz.axis_shear_sliding(0.5)),
        *[(PressureLoad(), "zz", z, hertz.axis_stress(z, 0.3)[0]) for z in (0.2, 0.5, 1.0)],
        *[(PressureLoad(), name, z, hertz.axis_stress(z, 0.3)[1]) for z in (0.2, 0.5, 1.0) for name in ("xx", "yy")],
    ],
)
def test_hertz_axis_converges_with_order_two(load, component, z, exact):
    errors = np.abs([axis_error(load, component, z, n, exact) for n in CELLS])
    slope = np.polyfit(np.log(CELLS), np.log(errors), 1)[0]
    assert abs(slope + 2.0) < 0.05  # measured -2.02 to -1.99: scatter from the cells that the edge cuts
    assert errors[-1] < 6e-5


@pytest.mark.parametrize(("z", "reference"), [(0.2, -0.60721), (0.5, -0.26964), (1.0, -0.07190)])
def test_sliding_hertz_shear_on_the_axis(z, reference):
    """Case HM-2, tau_xz / (mu p0) printed with five digits; 64 cells across the contact radius."""
    assert axis_error(ShearLoadX(), "xz", z, 64, reference) == close(0.0, abs=4.5e-5)


# --- registration ------------------------------------------------------------------------------------------------


def test_registered_and_cited():
    registry = load_plugins(KINDS, discovered=(), extra=[surface_loads])
    found = {entry.key: entry.component for entry in registry.of_kind("surface-influence")}
    assert found == {"pressure": PressureLoad, "shear-x": ShearLoadX, "shear-y": ShearLoadY}
    assert [load.traction for load in LOADS] == ["p", "q_x", "q_y"]
    assert all(any("Johnson 1985" in source for source in load.references) for load in LOADS)


@pytest.mark.parametrize("load", LOADS, ids=lambda load: load.traction)
def test_a_lattice_wider_than_the_rectangles(load):
    """Rectangles that do not touch share no corners: the lattice holds the values at separate points."""
    lattice, widths = 3e-6 * np.arange(4), (1e-6, 1e-6)
    values = load.sample("stress", ["xx", "xz"], lattice, lattice, 1e-6, widths, material(0.3))
    separate = load.stress(["xx", "xz"], lattice[None, :], lattice[:, None], 1e-6, widths, material(0.3))
    assert values == close(separate, rel=1e-12)
