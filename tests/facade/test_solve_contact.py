"""A contact from numbers: against closed forms, against scenes, and what is refused."""

import inspect

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact_verification.oracles import hertz

E, NU, R, LOAD = 210e9, 0.3, 105e-6, 0.65
STEEL = ec.HalfSpace(E, NU)
A, P0, APPROACH = hertz.hertz_sphere(LOAD, R, E / (1 - NU**2))
DX = 0.2e-6
X = (np.arange(81) - 40) * DX
GAP = (X**2 + X[:, None] ** 2) / (2 * R)


@pytest.fixture(scope="module")
def pressed():
    return ec.solve_contact(GAP, STEEL, load=LOAD, spacing=DX)


def test_hertz_on_an_own_gap(pressed):
    assert pressed.max_pressure == close(P0, rel=1e-3)
    assert pressed.approach == close(APPROACH, rel=2e-3)
    assert pressed.radius == close(A, rel=5e-3)
    assert pressed.contact_area == close(np.pi * A**2, rel=1e-2)
    assert pressed.load == close(LOAD, rel=1e-6)
    assert pressed.pressure.shape == pressed.gap.shape == GAP.shape
    inside = np.hypot(*np.meshgrid(X, X)) < 0.9 * A
    assert np.abs(pressed.pressure[inside] - hertz.pressure(*np.meshgrid(X, X), A, A, P0)[inside]).max() < 0.02 * P0
    assert np.abs(pressed.gap[inside]).max() < 1e-5 * APPROACH
    np.testing.assert_allclose(pressed.x, X, atol=1e-15)
    assert not pressed.shear.any()


def test_stress_on_the_axis_is_that_of_johnson(pressed):
    z = np.array([0.3, 0.481, 1.0, 2.0]) * A
    stress = pressed.stress(np.column_stack([0 * z, 0 * z, z]))
    axial, radial = hertz.axis_stress(z / A, NU)
    np.testing.assert_allclose(stress[:, 2, 2], P0 * axial, atol=2e-3 * P0)
    np.testing.assert_allclose(stress[:, 0, 0], P0 * radial, atol=2e-3 * P0)
    np.testing.assert_array_equal(stress, stress.transpose(0, 2, 1))


def test_fields_of_the_result_are_those_of_its_own_tractions(pressed):
    points = [[2e-6, -1e-6, 1e-6], [0.1e-6, 0.0, 0.01e-6], [9e-6, 3e-6, 4e-6]]
    for quantity in ("stress", "displacement"):
        found = getattr(pressed, quantity)(points)
        own = getattr(STEEL, quantity)(points, pressure=pressed.pressure, spacing=DX)
        np.testing.assert_allclose(found, own, atol=1e-9 * np.abs(own).max())
    u = pressed.displacement([[X[50], X[44], 0.0]])
    assert u[0, 2] == close(pressed.approach - GAP[44, 50], rel=1e-5)


def test_a_component_an_array_and_a_scene_are_one_contact(pressed):
    ball = ec.make("sphere", radius=R)
    window = {"cells": 81, "spacing": DX}
    one = ec.solve_contact(ball, STEEL, load="0.65 N", **window)
    np.testing.assert_allclose(one.pressure, pressed.pressure, atol=1e-6 * P0)
    two = ec.solve_contact([{"type": "sphere", "radius": 2 * R}] * 2, (STEEL, None), load=LOAD, **window)
    np.testing.assert_allclose(two.pressure, one.pressure, atol=1e-6 * P0)
    size = ec.solve_contact(GAP, STEEL, approach=pressed.approach, size=81 * DX)
    np.testing.assert_allclose(size.pressure, pressed.pressure, atol=1e-4 * P0)


def test_two_bodies_and_the_field_in_the_upper_one():
    both = ec.solve_contact(GAP, (STEEL, STEEL), load=LOAD / 2, spacing=DX)
    assert both.radius == close(A, rel=5e-3)  # half the stiffness under half the load
    points = [[1e-6, 0.0, 2e-6], [0.0, 3e-6, 5e-6]]
    np.testing.assert_allclose(both.stress(points, body=2), both.stress(points), rtol=1e-9, atol=1e-6 * P0)


def test_steps_one_after_the_other():
    found = ec.solve_contact(GAP, STEEL, load=[0.2, "0.65 N"], spacing=DX)
    assert found.steps == 2
    assert (found.at(1).load, found.load) == (close(0.2, rel=1e-6), close(0.65, rel=1e-6))
    a, p0, _ = hertz.hertz_sphere(0.2, R, E / (1 - NU**2))
    axial = hertz.axis_stress(np.array([1.0]), NU)[0][0]
    assert found.at(1).stress([[0, 0, a]])[0, 2, 2] == close(p0 * axial, rel=5e-3)
    assert "step 1 of 2" in repr(found.at(1))
    section = found.region(name="line", shape="line", start=[0, 0, 0], end=[0, 0, A], count=3)
    assert section.line_stress.sizes["line_point"] == 3


def test_friction():
    found = ec.solve_contact(
        GAP, STEEL, load=LOAD, friction=0.4, tangential_load=(0.13, 0.0), numerics={"coupling": "partial"}, spacing=DX
    )
    q = np.hypot(*found.shear)
    assert found.shear[0].sum() * DX**2 == close(0.13, rel=1e-6)
    assert np.all(q <= 0.4 * found.pressure * (1 + 1e-6))
    assert float(found.dataset.stick_radius[-1]) == close(A * 0.5 ** (1 / 3), rel=3e-2)  # Cattaneo, Mindlin
    points = [[3e-6, 1e-6, 1e-6]]
    own = STEEL.stress(points, pressure=found.pressure, shear=found.shear, spacing=DX)
    np.testing.assert_allclose(found.stress(points), own, atol=1e-9 * P0)
    law = {"type": "coulomb", "coefficient": 0.4}
    slid = ec.solve_contact(GAP, STEEL, load=LOAD, friction=law, shift="1 um", spacing=DX)
    # less than the coefficient times the load: some of the shear points along y
    assert slid.shear[0].sum() * DX**2 == close(0.4 * LOAD, rel=1e-3)


def test_layers():
    alike = ec.Layered([("2 um", E, NU), ("1 um", E, NU)], substrate=(E, NU))
    stiff = ec.Layered([("2 um", 2 * E, NU)], substrate=STEEL)
    one, other, hard = (ec.solve_contact(GAP, body, load=LOAD, spacing=DX) for body in (STEEL, alike, stiff))
    np.testing.assert_allclose(other.pressure, one.pressure, atol=1e-4 * P0)
    points = [[0, 0, 1e-6], [2e-6, 0, 3e-6]]
    np.testing.assert_allclose(other.stress(points), one.stress(points), atol=1e-4 * P0)
    np.testing.assert_allclose(
        alike.stress(points, pressure=one.pressure, spacing=DX), one.stress(points), atol=1e-4 * P0
    )
    assert hard.max_pressure > 1.1 * one.max_pressure
    assert hard.approach < one.approach


def test_looks(pressed):
    assert repr(pressed).startswith("ContactResult(normal load 650 mN, approach 348")
    html = pressed._repr_html_()
    assert "<th" in html
    assert "81 x 81" in html
    import matplotlib.pyplot as plt

    axes = pressed.plot()
    drawn = [part.get_array() for part in (*axes.collections, *axes.images) if part.get_array() is not None]
    assert max(float(np.nanmax(values)) for values in drawn) == close(pressed.max_pressure / 1e9, rel=1e-9)
    assert "gap" in pressed.plot("gap", style="paper").get_title().lower()

    plt.close("all")


WRONG = ec.Voxels(np.full((1, 2, 2), 5), DX, {5: {"young_modulus": -1.0, "poisson_ratio": 0.2}})
REFUSED = [
    ({}, "solve_contact must be given load or approach (got neither)"),
    ({"load": 1, "approach": 1e-7}, "solve_contact must be given load or approach (got both)"),
    ({"load": -1.0}, "solve_contact: load must be zero or positive, and finite [N]"),
    ({"load": "1 m"}, "solve_contact: load must be a force [N]"),
    ({"load": 1, "spacing": None}, "solve_contact.spacing must be given with an array"),
    ({"load": 1, "spacing": 0.0}, "solve_contact.spacing must be positive and finite [m] (got 0.0)"),
    ({"load": 1, "spacing": "5 N"}, "solve_contact.spacing must be a length [m]"),
    ({"load": 1, "gap": GAP[0]}, "a row (nx,) makes a line contact with length='infinite' (got (81,))"),
    ({"load": 1, "gap": GAP * np.nan}, "solve_contact.gap must be finite everywhere [m]"),
    ({"load": 1, "gap": 3.0}, "solve_contact.gap must be an array (ny, nx) [m], a geometry component"),
    ({"load": 1, "bodies": None}, "solve_contact.bodies must be a HalfSpace or Layered"),
    ({"load": 1, "cells": 4}, "solve_contact.cells must be left out: the gap has 81 x 81 cells"),
    ({"load": 1, "tangential_load": 0.1}, "solve_contact.friction must be given with tangential_load"),
    ({"load": 1, "friction": -0.1}, "solve_contact: friction must be zero or positive, and finite [-] (got -0.1)"),
    ({"load": 1, "friction": {"type": "coulom"}}, "unknown friction-law 'coulom'"),
    ({"load": 1, "increments": 0}, "solve_contact: increments must be 1 or more (got 0)"),
    ({"load": 1, "gap": {"type": "sphere", "radius": R}}, "two of cells, size and spacing, or none"),
    ({"load": 1, "bodies": ec.HalfSpace(E, NU, law={"type": "j2"})}, "bodies.1.law.hardening must be given"),
    ({"load": 1, "bodies": (None, ec.HalfSpace(E, NU, law={"type": "j2"}))}, "bodies.2.law.hardening must be given"),
    ({"load": 1, "bodies": ec.HalfSpace(E, NU, inclusions={"type": "sphere"})}, "HalfSpace.inclusions[0] must be"),
    ({"load": 1, "bodies": ec.HalfSpace(E, NU, voxels=WRONG)}, "Voxels.materials[5].material.young-modulus"),
    ({"load": 1, "friction": 0.1, "shift": 1e-7, "tangential_load": 0.1}, "or shift (got both)"),
    ({"load": 1, "steps": [{"normal-load": 1}]}, "solve_contact.steps must be given alone"),
    ({"load": 1, "numerics": {"tolerances": 1e-6}}, "unknown key 'tolerances'"),
]


@pytest.mark.parametrize(("changes", "words"), REFUSED)
def test_refusals_name_the_argument(changes, words):
    arguments = {"gap": GAP, "bodies": STEEL, "spacing": DX} | changes
    with pytest.raises(ec.EigencontactError) as caught:
        ec.solve_contact(arguments.pop("gap"), arguments.pop("bodies"), **arguments)
    assert words in str(caught.value)
    assert "steps.normal-load" not in str(caught.value)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda found: found.stress([[0, 0, -1e-6]]), "ContactResult.stress.points must be at z of 0 or more [m]"),
        (lambda found: found.stress([[0, 0, 1e-6]], body=2), "ContactResult.stress.body must be one that is elastic"),
        (lambda found: found.at(2), "ContactResult.step must be 1 to 1 (got 2)"),
        (lambda found: found.plot("pressur"), "'pressure'"),
    ],
)
def test_results_refuse(pressed, call, words):
    with pytest.raises(ec.EigencontactError) as caught:
        call(pressed)
    assert words in str(caught.value)


def test_each_use_is_short():
    for use in (test_friction, test_layers, test_steps_one_after_the_other):
        assert len(inspect.getsource(use).splitlines()) < 20
