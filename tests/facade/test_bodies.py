"""Fields under given tractions, regions of voxels, and what bodies say they are."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eigencontact as ec
from close import close

E, NU = 210e9, 0.3
STEEL = ec.HalfSpace("210 GPa", NU)
POINTS = np.array([[0.2, -0.1, 0.7], [1.5, 0.3, 2.0], [-0.9, 0.4, 0.6]])


@pytest.mark.parametrize("body", [STEEL, ec.Layered([(1.5, E, NU)], (E, NU))])
@pytest.mark.parametrize("quantity", ["stress", "displacement"])
def test_one_cell_is_the_loaded_rectangle(body, quantity):
    """Boussinesq, Cerruti and Love, in closed form; one cell of several that bear nothing, off the middle."""
    pressure, shear = np.zeros((3, 5)), np.zeros((2, 3, 5))
    pressure[1, 3], shear[0, 1, 3], shear[1, 1, 3] = 3e6, 1e6, -2e6
    found = getattr(body, quantity)(POINTS, pressure=pressure, shear=shear, spacing=(0.8, 1.1), center=(0.1, 0.2))
    at = POINTS - [0.9, 0.2, 0.0]
    rectangle = ec.rectangle_field(
        (1e6, -2e6, 3e6), (0.4, 0.55), at, quantity=quantity, young_modulus=E, poisson_ratio=NU
    )
    np.testing.assert_allclose(found, rectangle, atol=1e-5 * np.abs(rectangle).max())


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**31), st.floats(-3, 3), st.floats(-3, 3))
def test_fields_superpose(seed, one, other):
    drawn = np.random.default_rng(seed)
    p, q = drawn.normal(size=(2, 3, 4)), drawn.normal(size=(2, 2, 3, 4))
    where = {"points": POINTS, "spacing": 0.5}
    for field in (STEEL.stress, STEEL.displacement):
        both = field(pressure=one * p[0] + other * p[1], shear=one * q[0] + other * q[1], **where)
        parts = one * field(pressure=p[0], shear=q[0], **where) + other * field(pressure=p[1], shear=q[1], **where)
        np.testing.assert_allclose(both, parts, atol=1e-11 * np.abs(field(pressure=np.ones((3, 4)), **where)).max())


def test_below_a_uniform_pressure_at_the_surface():
    wide = STEEL.stress([[0.0, 0.0, 0.0]], pressure=np.full((41, 41), 2e6), spacing=1.0)
    assert wide[0, 2, 2] == close(-2e6, rel=1e-6)
    assert wide[0, 0, 0] == close(wide[0, 1, 1], rel=1e-6)


LABELS = np.zeros((6, 8, 8), dtype=int)
LABELS[1:3, 2:6, 3:5] = 5
X = (np.arange(32) - 15.5) * 0.5e-6
GAP = (X**2 + X[:, None] ** 2) / (2 * 105e-6)


def test_eigenstrain_by_voxels_adds_the_field_of_the_cuboid():
    """What a body does beside its tractions is the exact field of the region, on the surface and below it."""
    swollen = ec.HalfSpace(E, NU, voxels=ec.Voxels(LABELS, "0.5 um", {5: {"eigenstrain": 1e-3}}))
    found = ec.solve_contact(GAP, swollen, load=0.3, spacing="0.5 um")
    box = ec.make("cuboid", kind="inclusion-shape", center=(0, 0, 1e-6), edges=(1e-6, 2e-6, 1e-6))
    points = [[0.25e-6, 0.25e-6, 2.5e-6], [2e-6, 1e-6, 1e-6], [0.75e-6, 1.75e-6, 0.7e-6]]
    for quantity in ("stress", "displacement"):
        whole = getattr(found, quantity)(points)
        tractions = getattr(STEEL, quantity)(points, pressure=found.pressure, spacing="0.5 um")
        exact = ec.inclusion_field(box, 1e-3 * np.eye(3), points, young_modulus=E, poisson_ratio=NU, quantity=quantity)
        np.testing.assert_allclose(whole - tractions, exact, atol=2e-5 * np.abs(exact).max())


YIELDING = {"type": "j2", "hardening": {"type": "perfect", "yield_stress": "1 GPa"}}


@pytest.mark.parametrize(
    "material",
    [{"young_modulus": "630 GPa", "poisson_ratio": 0.2}, YIELDING],
)
def test_materials_by_voxels_are_those_of_the_box(material):
    voxels = ec.HalfSpace(E, NU, voxels=ec.Voxels(LABELS, 0.5e-6, {5: material}))
    shape = {"type": "cuboid", "center": (0, 0, 1e-6), "edges": (1e-6, 2e-6, 1e-6)}
    box = ec.HalfSpace(E, NU, inclusions=[{**shape, "material": material}])
    one, other = (
        ec.solve_contact(GAP, body, load=0.3, spacing=0.5e-6, numerics={"inclusion-pitch": 0.5e-6})
        for body in (voxels, box)
    )
    plain = ec.solve_contact(GAP, STEEL, load=0.3, spacing=0.5e-6)
    peak = plain.max_pressure
    np.testing.assert_allclose(one.pressure, other.pressure, atol=1e-6 * peak)
    assert np.abs(one.pressure - plain.pressure).max() > 0.01 * peak
    point = [[0.3e-6, 0.2e-6, 1.1e-6]]
    np.testing.assert_allclose(one.stress(point), other.stress(point), atol=1e-6 * peak)


def test_both_bodies_may_have_voxels():
    swollen = ec.HalfSpace(E, NU, voxels=ec.Voxels(LABELS, "0.5 um", {5: {"eigenstrain": 1e-3}}))
    found = ec.solve_contact(GAP, (swollen, swollen), load=0.3, spacing="0.5 um")
    one, other = (found.stress([[0.75e-6, 0.25e-6, 1e-6]], body=number) for number in (1, 2))
    np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-9 * np.abs(one).max())


def test_bodies_say_what_they_are():
    voxels = ec.Voxels(LABELS, (0.5e-6, 0.5e-6, 1e-6), {5: {"void": True}})
    assert repr(voxels) == "Voxels(8 x 8 x 6 of 500 nm x 1 um, materials 5)"
    assert voxels.origin == (-2e-6, -2e-6, 0.0)
    law = ec.HalfSpace(E, NU, law=YIELDING)
    assert repr(law) == "HalfSpace('210 GPa', 0.3, law 'j2')"
    assert repr(ec.HalfSpace(E, NU, voxels=voxels)).endswith("0.3, Voxels(8 x 8 x 6 of 500 nm x 1 um, materials 5))")
    assert repr(ec.Layered([(2e-6, 4e11, 0.2), (1e-6, E, NU)], STEEL)) == (
        "Layered([('2 um', '400 GPa', 0.2), ('1 um', '210 GPa', 0.3)], substrate=('210 GPa', 0.3))"
    )


P = np.ones((2, 2))


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: ec.HalfSpace(-1.0, 0.3), "HalfSpace.young_modulus must be positive and finite [Pa] (got -1.0)"),
        (lambda: ec.HalfSpace("1 N", 0.3), "HalfSpace.young_modulus must be a stress [Pa]"),
        (lambda: ec.HalfSpace(1.0, 0.6), "HalfSpace.poisson_ratio must be in (-1, 0.5]"),
        (lambda: ec.HalfSpace(1.0, 0.3, voxels=LABELS), "HalfSpace.voxels must be Voxels, or None"),
        (lambda: ec.Layered([], STEEL), "Layered.layers must be one layer or more"),
        (lambda: ec.Layered([(1, 2)], STEEL), "Layered.layers.0 must be (thickness, young_modulus, poisson_ratio)"),
        (lambda: ec.Layered([(-1, 2, 0.3)], STEEL), "thickness must be positive"),
        (lambda: ec.Layered([(1, 2, 0.3)], 5), "Layered.substrate must be a HalfSpace, or (young_modulus"),
        (lambda: ec.Voxels(LABELS[0], 1.0, {5: {"void": True}}), "Voxels.labels must be an array (nz, ny, nx) of"),
        (lambda: ec.Voxels(LABELS, 1.0, {}), "Voxels.materials must be given for each number but 0, so for [5]"),
        (lambda: ec.Voxels(LABELS, 1.0, {5: {}}), "Voxels.materials[5] must be a table of a constitutive law"),
        (lambda: ec.Voxels(LABELS, (1.0, 2.0), {5: {"void": True}}), "Voxels.spacing must be one length or 3 [m]"),
        (
            lambda: ec.Voxels(LABELS, 1.0, {5: {"void": True}}, origin=(0, 0, -1)),
            "Voxels.origin must be at a depth z of 0 or more [m]",
        ),
        (lambda: STEEL.stress([[0, 0, 1]], spacing=1.0), "must be given a pressure (ny, nx), a shear (2, ny, nx), or"),
        (lambda: STEEL.stress([[0, 0, -1]], pressure=P, spacing=1.0), "points must be at z of 0 or more"),
        (lambda: STEEL.stress([[0, 0, 1]], pressure=P[0], spacing=1.0), "pressure must be an array (ny, nx) [Pa]"),
        (lambda: STEEL.stress([[0, 0, 1]], shear=P, spacing=1.0), "shear must be an array (2, ny, nx) [Pa]"),
        (
            lambda: ec.HalfSpace(E, NU, law=YIELDING).stress([[0, 0, 1]], pressure=P, spacing=1.0),
            "HalfSpace.stress must be of a body of elastic constants and layers alone",
        ),
    ],
)
def test_refusals(call, words):
    with pytest.raises(ec.EigencontactError) as caught:
        call()
    assert words in str(caught.value)
